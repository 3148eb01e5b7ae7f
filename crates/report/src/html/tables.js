"use strict";
// Sorts a table by a click on a heading - rising, falling, as it was - and copies it as comma-separated values.
(() => {
  const textOf = (cell) => cell.textContent.trim();
  // The number that a text begins with: "−1.2 ± 0.3°" is −1.2, "< 0.0001" is 0.0001, "3.2e−7" is 3.2e-7.
  const numberOf = (text) => {
    const found = /^[<>+ ]*([-−]?\d+(?:\.\d+)?(?:e[-−+]?\d+)?)/.exec(text);
    return found ? Number(found[1].replaceAll("−", "-")) : NaN;
  };
  const isNothing = (text) => text === "" || text === "–";

  const compare = (a, b) => {
    // What is undefined stands last, whichever way the others are sorted.
    const [x, y] = [numberOf(a), numberOf(b)];
    return Number.isNaN(x) || Number.isNaN(y) ? a.localeCompare(b) : x - y;
  };
  const field = (cell) => {
    const text = textOf(cell).replaceAll("−", "-");
    // A cell that a spreadsheet would run is written harmless.
    const harmless = /^[=@+\t\r-]/.test(text) && Number.isNaN(numberOf(text)) ? `'${text}` : text;
    return /[",;\n]/.test(harmless) ? `"${harmless.replaceAll("\"", "\"\"")}"` : harmless;
  };
  const valuesOf = (table) => [...table.rows]
    .map((row) => [...row.cells].filter((cell) => !cell.matches(".picture")).map(field).join(","))
    .join("\n") + "\n";

  const copy = async (text) => {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch {
      // Where the page may not use the clipboard by itself.
      const area = document.createElement("textarea");
      area.value = text;
      document.body.append(area);
      area.select();
      const done = document.execCommand("copy");
      area.remove();
      return done;
    }
  };

  const start = (table) => {
    const body = table.tBodies[0];
    const original = [...body.rows];
    const headings = [...table.tHead.rows[0].cells];
    const sort = (column) => {
      const heading = headings[column];
      const now = heading.getAttribute("aria-sort");
      headings.forEach((other) => other.removeAttribute("aria-sort"));
      if (now === "descending") {
        body.append(...original);
        return;
      }
      const way = now === "ascending" ? -1 : 1;
      heading.setAttribute("aria-sort", way === 1 ? "ascending" : "descending");
      const text = (row) => textOf(row.cells[column]);
      const told = original.filter((row) => !isNothing(text(row)));
      told.sort((a, b) => way * compare(text(a), text(b)));
      body.append(...told, ...original.filter((row) => isNothing(text(row))));
    };
    headings.forEach((heading, column) => {
      heading.tabIndex = 0;
      heading.title = "sort";
      heading.addEventListener("click", () => sort(column));
      heading.addEventListener("keydown", (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        sort(column);
      });
    });
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = "copy as CSV";
    button.addEventListener("click", async () => {
      const done = await copy(valuesOf(table));
      button.textContent = done ? "copied" : "not copied";
      setTimeout(() => { button.textContent = "copy as CSV"; }, 1500);
    });
    table.after(button);
  };

  for (const table of document.querySelectorAll(".table > table")) start(table);
})();
