// A table of thousands of rows: only those in sight are in the document. Sorted by its headings, read with the arrows.
class Grid {
  static ROW = 28; // px
  static SPARE = 8; // rows above and below those in sight

  // columns: {title, text(row), sort(row), style(row), href(row)}; all but title and text may be missing
  constructor(place, label, columns, rows) {
    this.columns = columns;
    this.every = this.rows = rows;
    this.sorted = null;
    this.active = { row: 0, column: 0 };
    const widths = columns.map((column) => {
      let most = column.title.length + 2;
      for (const row of rows) most = Math.max(most, column.text(row).length);
      return `${Math.min(most, 60) + 2}ch`;
    });
    this.widths = widths.join(" ");
    this.head = made("div", { role: "row", class: "row head" });
    this.head.style.gridTemplateColumns = this.widths;
    columns.forEach((column, number) => {
      const button = made("button", { type: "button", title: `sort by ${column.title}` }, column.title);
      button.addEventListener("click", () => this.sort(number));
      this.head.append(made("div", { role: "columnheader", "aria-sort": "none" }, button));
    });
    this.sheet = made("div", { class: "sheet", role: "rowgroup" });
    this.view = made("div", { class: "view" }, this.head, this.sheet);
    this.host = made("div", { role: "grid", "aria-label": label, "aria-colcount": columns.length, class: "grid" }, this.view);
    place.append(this.host);
    this.view.addEventListener("scroll", () => this.draw());
    window.addEventListener("resize", () => this.draw());
    this.sheet.addEventListener("keydown", (event) => this.key(event));
    this.sheet.addEventListener("focusin", (event) => {
      const cell = event.target.closest("[data-column]");
      if (!cell) return;
      this.active = { row: Number(cell.dataset.row), column: Number(cell.dataset.column) };
      for (const other of this.sheet.querySelectorAll('[tabindex="0"]')) other.tabIndex = -1;
      cell.tabIndex = 0;
    });
    this.show(rows);
  }

  show(rows) {
    this.rows = this.order(rows);
    this.shown = rows;
    this.active.row = 0;
    this.view.scrollTop = 0;
    this.sheet.style.height = `${rows.length * Grid.ROW}px`;
    this.host.setAttribute("aria-rowcount", rows.length + 1);
    this.draw(true);
  }

  order(rows) {
    if (this.sorted === null) return rows;
    const column = this.columns[this.sorted.column];
    const key = column.sort || column.text;
    const keyed = rows.map((row, place) => [key(row), place, row]);
    const turn = this.sorted.down ? -1 : 1;
    keyed.sort(([a, i], [b, j]) => {
      if (a === b) return i - j;
      if (a === null || a === undefined) return 1; // what is not there comes last, in both directions
      if (b === null || b === undefined) return -1;
      if (typeof a === "number" && typeof b === "number") return turn * (a - b);
      return turn * String(a).localeCompare(String(b), "en", { numeric: true }) || i - j;
    });
    return keyed.map(([, , row]) => row);
  }

  sort(number) {
    const down = this.sorted !== null && this.sorted.column === number && !this.sorted.down;
    this.sorted = { column: number, down };
    [...this.head.children].forEach((cell, i) => {
      cell.setAttribute("aria-sort", i !== number ? "none" : down ? "descending" : "ascending");
    });
    this.show(this.shown);
  }

  draw(anew) {
    const height = this.view.clientHeight || 600;
    const first = Math.max(0, Math.floor(this.view.scrollTop / Grid.ROW) - Grid.SPARE);
    const last = Math.min(this.rows.length, Math.ceil((this.view.scrollTop + height) / Grid.ROW) + Grid.SPARE);
    if (!anew && this.first === first && this.last === last) return;
    const focused = this.sheet.contains(document.activeElement);
    this.first = first;
    this.last = last;
    const rows = [];
    for (let number = first; number < last; number++) rows.push(this.line(number));
    this.sheet.replaceChildren(...rows);
    const cell = this.cell();
    if (cell) {
      cell.tabIndex = 0;
      if (focused) cell.focus({ preventScroll: true });
    } else if (rows.length) rows[0].firstChild.tabIndex = 0;
  }

  line(number) {
    const row = this.rows[number];
    const line = made("div", { role: "row", class: "row", "aria-rowindex": number + 2 });
    line.style.top = `${number * Grid.ROW}px`;
    line.style.gridTemplateColumns = this.widths;
    this.columns.forEach((column, i) => {
      const text = column.text(row);
      const href = column.href ? column.href(row) : null;
      const cell = made(
        href ? "a" : "div",
        { role: "gridcell", class: column.style ? column.style(row) : null, href, title: text.length > 44 ? text : null },
        text,
      );
      cell.dataset.row = number;
      cell.dataset.column = i;
      cell.tabIndex = -1;
      line.append(cell);
    });
    return line;
  }

  cell() {
    return this.sheet.querySelector(`[data-row="${this.active.row}"][data-column="${this.active.column}"]`);
  }

  key(event) {
    const page = Math.max(1, Math.floor(this.view.clientHeight / Grid.ROW) - 2);
    const moves = {
      ArrowDown: [1, 0], ArrowUp: [-1, 0], ArrowRight: [0, 1], ArrowLeft: [0, -1], PageDown: [page, 0], PageUp: [-page, 0],
      Home: event.ctrlKey ? [-Infinity, 0] : [0, -Infinity], End: event.ctrlKey ? [Infinity, 0] : [0, Infinity],
    };
    const move = moves[event.key];
    if (!move || event.altKey || event.metaKey) return;
    event.preventDefault();
    const within = (value, most) => Math.max(0, Math.min(value, most));
    this.active.row = within(this.active.row + move[0], this.rows.length - 1);
    this.active.column = within(this.active.column + move[1], this.columns.length - 1);
    const top = this.active.row * Grid.ROW;
    const room = this.view.clientHeight - this.head.offsetHeight - Grid.ROW;
    if (top < this.view.scrollTop) this.view.scrollTop = top;
    else if (top > this.view.scrollTop + room) this.view.scrollTop = top - room;
    this.draw();
    const cell = this.cell();
    if (cell) {
      cell.focus({ preventScroll: true });
      cell.scrollIntoView({ block: "nearest", inline: "nearest" });
    }
  }
}

// Words that all must occur, and choices; says how many rows are left.
function filtered(place, label, grid, texts, choices) {
  const words = made("input", { type: "search", placeholder: "words that must occur", "aria-label": `filter ${label}` });
  const count = made("output", { "aria-live": "polite" });
  const selects = choices.map((choice) => {
    const select = made("select", { "aria-label": choice.label });
    choice.options.forEach(([text], i) => select.append(made("option", { value: i }, text)));
    return select;
  });
  const lower = new Map();
  const apply = () => {
    const wanted = words.value.toLowerCase().split(/\s+/).filter(Boolean);
    const left = grid.every.filter((row) => {
      if (!choices.every((choice, i) => choice.options[selects[i].value][1](row))) return false;
      if (!wanted.length) return true;
      if (!lower.has(row)) lower.set(row, texts(row).toLowerCase());
      return wanted.every((word) => lower.get(row).includes(word));
    });
    count.textContent = `${left.length} of ${grid.every.length} rows`;
    grid.show(left);
  };
  for (const control of [words, ...selects]) control.addEventListener("input", apply);
  place.prepend(made("div", { class: "filter" }, words, ...selects, count));
  apply();
}
