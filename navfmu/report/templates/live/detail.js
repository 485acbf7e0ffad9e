// What a cell of the matrix and what a run says, over the page: "#cell/3/0" and "#run/12" are links to them.
const dialog = document.getElementById("detail");
let before = null; // what had the focus

function routed() {
  const found = /^#(cell|run)\/(\d+)(?:\/(\d+))?$/.exec(location.hash);
  const content = found && (found[1] === "run" ? runDetail(Number(found[2])) : cellDetail(Number(found[2]), Number(found[3])));
  if (!content) {
    if (dialog.open) dialog.close();
    return;
  }
  const close = made("button", { type: "button", class: "close", "aria-label": "close" }, "Close");
  close.addEventListener("click", () => dialog.close());
  dialog.replaceChildren(close, ...content);
  if (!dialog.open) {
    before = document.activeElement;
    dialog.showModal();
  }
  dialog.scrollTop = 0;
  dialog.querySelector("h2").focus();
}

dialog.addEventListener("close", () => {
  dialog.replaceChildren();
  if (location.hash) history.replaceState(null, "", location.pathname + location.search);
  if (before && before.isConnected) before.focus({ preventScroll: true });
});
window.addEventListener("hashchange", routed);

function title(text) {
  return made("h2", { tabindex: "-1", id: "detail-title" }, text);
}

function listed(head, rows) {
  const table = made("table", {}, made("tr", {}, ...head.map((text) => made("th", { scope: "col" }, text))));
  for (const row of rows) table.append(made("tr", {}, ...row.map((cell) => (cell instanceof Node ? cell : made("td", {}, String(cell))))));
  return made("div", { class: "wide" }, table);
}

function cellDetail(g, r) {
  const group = story.groups[g], requirement = story.requirements[r];
  const cell = group && requirement && group.cells[r];
  if (!cell) return null;
  const runs = group.runs.map((number) => [number, story.runs[number].findings[r]]);
  const key = ([number, f]) => (number === cell.worst ? -2 : f === null ? -1 : f.held ? 1000 + f.inside : f.inside);
  runs.sort((a, b) => key(a) - key(b));
  const share = cell.interval ? `: ${cell.interval[0].toFixed(0)} to ${cell.interval[1].toFixed(0)} % of such runs hold (95 % interval)` : "";
  return [
    title(`${requirement.id} in ${group.variant}, ${story.cases[group.case].name}: ${verdictText(cell)}`),
    made("p", {}, `${requirement.description ? `${requirement.description}: ` : ""}${requirement.sentence}`),
    made("p", {}, `${cell.sentence}${share}.`),
    made("h3", {}, "Its runs, worst first"),
    listed(
      ["run", "finding", "inside", "worst", "at s", "first violated at s"],
      runs.map(([number, f]) => [
        made("td", {}, made("a", { href: `#run/${number}` }, `seed ${story.runs[number].seed}`)),
        ...(f === null ? [story.runs[number].error ? "ended with an error" : "not asked", "", "", "", ""] : findingCells(f)),
      ]),
    ),
  ];
}

function findingCells(f) {
  const [style, words] = { true: ["good", "as asked"], false: ["bad", "NOT AS ASKED"], null: ["none", "asked of all runs"] }[f.held];
  const verdict = made("td", { class: style }, words);
  return [verdict, f.share, f.text, f.at === null ? "" : Number(f.at.toPrecision(9)), f.first === null ? "never" : Number(f.first.toPrecision(9))];
}

function runDetail(number) {
  const run = story.runs[number];
  if (!run) return null;
  const values = story.axes.map((axis, i) => [axis, run.values[i]]).filter(([, value]) => value !== null);
  const content = [title(`${run.variant}, ${run.case}, seed ${run.seed}`)];
  if (values.length) content.push(made("p", {}, values.map(([axis, value]) => `${axis}: ${value}`).join(", ")));
  if (run.error) content.push(made("p", { class: "bad" }, `Ended with an error: ${run.error}`));
  const asked = story.requirements.map((r, i) => [r, run.findings[i]]).filter(([, f]) => f !== null);
  if (asked.length) {
    content.push(listed(
      ["requirement", "finding", "inside", "worst", "at s", "first violated at s"],
      asked.map(([r, f]) => [`${r.id}: ${r.sentence}`, ...findingCells(f)]),
    ));
  }
  if (run.faults.length) content.push(listed(["fault", "target", "type", "time"], run.faults));
  const said = [
    ...Object.entries(run.idle).map(([fault, why]) => `fault '${fault}' did not happen: ${why}`),
    ...Object.entries(run.not_finite).map(([signal, count]) => `${signal} is not finite at ${count} recorded points`),
    ...run.events.filter(([kind]) => kind === "notice").map(([, name, time]) => `noticed at t = ${Number(time.toPrecision(9))} s: ${name}`),
    ...run.notes.map((i) => story.notes[i][0]),
  ];
  if (said.length) content.push(made("ul", {}, ...said.map((text) => made("li", {}, text))));
  const command = made("pre", { tabindex: "0" }, run.command);
  const copy = made("button", { type: "button", class: "copy" }, "Copy");
  copy.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(run.command);
      copy.textContent = "Copied";
    } catch {
      getSelection().selectAllChildren(command);
      copy.textContent = "Selected: copy it with Ctrl+C";
    }
  });
  content.push(made("h3", {}, "The command that repeats it"), command, copy);
  if (run.recording) content.push(made("p", {}, `Its recording is ${run.recording} beside this report.`));
  const place = made("div", { class: "curves" });
  content.push(place);
  if (document.getElementById(`curves-${number}`)) {
    queueMicrotask(() => drawn(number, run, place).catch((error) => {
      place.append(made("p", { class: "bad" }, `The curves cannot be drawn in this browser: ${error}`));
      console.error(error);
    }));
  } else place.append(made("p", {}, run.recording ? "Its curves are not in this file (see 'All runs'); 'navfmu plot' draws the recording." : "It has no recording."));
  return content;
}
