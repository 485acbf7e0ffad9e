// The matrix and the list of runs.
const story = JSON.parse(document.getElementById("story").textContent);

function verdictOf(group) {
  const cells = group.cells.filter(Boolean);
  return !cells.length ? "not asked" : ["violated", "no answer", "holds"].find((verdict) => cells.some((cell) => cell.verdict === verdict));
}

// Louder where it does not hold, for those who see no colours.
function verdictText(cell) {
  return cell.passed ? cell.verdict : cell.verdict.toUpperCase();
}

function ofVariants() {
  const some = story.variants.map((name) => [name, (row) => row.variant === name]);
  return { label: "variant", options: [["every variant", () => true], ...some] };
}

function faultsOf(entry) {
  return entry.faults.map((fault) => `${fault.id} ${fault.fmea} ${fault.description}`).join(" ");
}

function matrix(place) {
  const rows = story.groups;
  const places = new Map(rows.map((row, place) => [row, place]));
  const columns = [
    { title: "variant", text: (row) => row.variant },
    { title: "case", text: (row) => story.cases[row.case].name },
    { title: "FMEA", text: (row) => [...new Set(story.cases[row.case].faults.map((f) => f.fmea).filter(Boolean))].join(", ") },
    ...story.requirements.map((requirement, r) => ({
      title: requirement.id,
      text: (row) => (row.cells[r] ? `${verdictText(row.cells[r])} ${row.cells[r].held}/${row.cells[r].total}` : "not asked"),
      sort: (row) => (row.cells[r] ? (row.cells[r].passed ? 1 : 0) + row.cells[r].held / Math.max(row.cells[r].total, 1) : null),
      style: (row) => (row.cells[r] ? (row.cells[r].passed ? "good" : "bad") : "none"),
      href: (row) => (row.cells[r] ? `#cell/${places.get(row)}/${r}` : null),
    })),
    ...story.axes.map((axis, i) => ({
      title: axis,
      text: (row) => valueText(story.cases[row.case].values[i]),
      sort: (row) => story.cases[row.case].values[i],
    })),
  ];
  const grid = new Grid(place, "verdicts by variant and case", columns, rows);
  const verdicts = ["violated", "no answer", "holds", "not asked"].map((v) => [{ violated: "violated somewhere", holds: "all hold" }[v] || v, (row) => verdictOf(row) === v]);
  filtered(place, "the matrix", grid, (row) => `${row.variant} ${story.cases[row.case].name} ${story.cases[row.case].description} ${faultsOf(story.cases[row.case])}`, [
    ofVariants(),
    { label: "verdict", options: [["every verdict", () => true], ...verdicts] },
  ]);
}

function valueText(value) {
  return value === null || value === undefined ? "" : typeof value === "number" ? String(Number(value.toPrecision(6))) : String(value);
}

function runs(place) {
  const rank = new Map(story.order.map((number, place) => [number, place]));
  const numbers = new Map(story.runs.map((run, number) => [run, number]));
  const rows = story.order.map((number) => story.runs[number]);
  const bad = (run) => run.error !== null || run.findings.some((f) => f && f.held === false);
  const columns = [
    { title: "run", text: (run) => String(numbers.get(run) + 1), sort: (run) => numbers.get(run), href: (run) => `#run/${numbers.get(run)}` },
    { title: "variant", text: (run) => run.variant },
    { title: "case", text: (run) => run.case, href: (run) => `#run/${numbers.get(run)}` },
    { title: "seed", text: (run) => String(run.seed), sort: (run) => run.seed },
    ...story.requirements.map((requirement, r) => ({
      title: requirement.id,
      text: (run) => (run.findings[r] ? [run.findings[r].share, run.findings[r].text].filter(Boolean).join(", ") : run.error ? "error" : ""),
      sort: (run) => (run.findings[r] ? run.findings[r].inside : null),
      style: (run) => (run.findings[r] ? { true: "good", false: "bad" }[run.findings[r].held] : run.error ? "bad" : "none"),
      href: (run) => `#run/${numbers.get(run)}`,
    })),
    ...story.axes.map((axis, i) => ({ title: axis, text: (run) => valueText(run.values[i]), sort: (run) => run.values[i] })),
    { title: "worst first", text: (run) => String(rank.get(numbers.get(run)) + 1), sort: (run) => rank.get(numbers.get(run)) },
  ];
  const grid = new Grid(place, "all runs", columns, rows);
  const cases = new Map(story.cases.map((entry) => [entry.name, entry]));
  const about = (run) => (cases.has(run.case) ? `${cases.get(run.case).description} ${faultsOf(cases.get(run.case))}` : "");
  filtered(place, "the runs", grid, (run) => `${run.variant} ${run.case} seed ${run.seed} ${run.error || ""} ${about(run)}`, [
    ofVariants(),
    {
      label: "finding",
      options: [
        ["every finding", () => true], ["not as asked", bad], ["as asked", (run) => !bad(run)],
        ["ended with an error", (run) => run.error !== null], ["a fault did not happen", (run) => Object.keys(run.idle).length > 0],
      ],
    },
  ]);
}

document.documentElement.classList.add("alive");
for (const [id, fill] of [["matrix", matrix], ["runs", runs]]) {
  const place = document.getElementById(id);
  if (place) fill(place);
}
