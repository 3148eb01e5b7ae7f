"use strict";
// Turns places at which somebody points in a picture into the flags that state them.
(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const NEEDED = { circle: 3, path: 5, places: 2, rectangle: 2, square: 4 };
  const pair = ([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`;
  const quoted = (places) => `'${places.map(pair).join(";")}'`;

  // The three unknowns of three equations, by Cramer's rule; none where they do not tell them.
  const solved = (m, v) => {
    const det = (a, b, c) =>
      a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1]) + c[0] * (a[1] * b[2] - a[2] * b[1]);
    const all = det(...m);
    const answer = [det(v, m[1], m[2]), det(m[0], v, m[2]), det(m[0], m[1], v)].map((d) => d / all);
    return answer.every(Number.isFinite) ? answer : null;
  };
  const leastSquares = (rows, values) => {
    const sum = (f) => rows.reduce((total, row, i) => total + f(row, i), 0);
    const columns = [0, 1, 2].map((j) => [0, 1, 2].map((i) => sum((row) => row[i] * row[j])));
    return solved(columns, [0, 1, 2].map((i) => sum((row, k) => row[i] * values[k])));
  };
  // The circle nearest to the places: begun with x² + y² = 2 a x + 2 b y + c, then by Gauss-Newton steps on the distances.
  const circle = (places) => {
    const [mx, my] = [0, 1].map((axis) => places.reduce((sum, p) => sum + p[axis], 0) / places.length);
    const about = places.map(([x, y]) => [x - mx, y - my]);
    const begun = leastSquares(about.map(([x, y]) => [2 * x, 2 * y, 1]), about.map(([x, y]) => x * x + y * y));
    if (!begun) return null;
    let [a, b, r] = [begun[0], begun[1], Math.sqrt(begun[2] + begun[0] ** 2 + begun[1] ** 2)];
    for (let step = 0; step < 20; step += 1) {
      const distances = about.map(([x, y]) => Math.hypot(x - a, y - b));
      const rows = about.map(([x, y], i) => [(x - a) / distances[i], (y - b) / distances[i], 1]);
      const change = leastSquares(rows, distances.map((d) => d - r));
      if (!change) return null;
      [a, b, r] = [a + change[0], b + change[1], r + change[2]];
    }
    const off = Math.sqrt(
      about.reduce((sum, [x, y]) => sum + (Math.hypot(x - a, y - b) - r) ** 2, 0) / about.length);
    return Number.isFinite(a + b + r) ? { cx: a + mx, cy: b + my, r, off } : null;
  };
  // Clockwise as seen, from the upper left.
  const around = (places) => {
    const [mx, my] = [0, 1].map((axis) => places.reduce((sum, p) => sum + p[axis], 0) / places.length);
    const angle = ([x, y]) => Math.atan2(y - my, x - mx);
    return [...places].sort((p, q) => angle(p) - angle(q));
  };

  const told = (tool, places, [width, height]) => {
    if (places.length < NEEDED[tool.told]) return { text: "", note: "" };
    if (tool.told === "circle") {
      const found = circle(places);
      if (!found) return { text: "", note: "these places lie on no circle" };
      const note = places.length > 3 ? `the places lie ${found.off.toFixed(1)} px off it` : "";
      return { text: `${tool.flag} ${[found.cx, found.cy, found.r].map((v) => v.toFixed(1)).join(",")}`, note, found };
    }
    if (tool.told === "rectangle") {
      const ends = [0, 1].map((axis) => {
        const most = [width, height][axis];
        const both = places.map((p) => Math.min(Math.max(Math.round(p[axis] + 0.5), 0), most));
        return [Math.min(...both), Math.max(...both)];
      });
      const [[left, right], [top, bottom]] = ends;
      if (left === right || top === bottom) return { text: "", note: "the rectangle holds no pixel" };
      return { text: `${tool.flag} ${left},${top},${right - left},${bottom - top}`, note: "" };
    }
    const ordered = tool.told === "square" ? around(places) : places;
    return { text: `${tool.flag} ${quoted(ordered)}`, note: "" };
  };

  const start = (root) => {
    const size = [Number(root.dataset.width), Number(root.dataset.height)];
    const tools = JSON.parse(root.querySelector("script.pointing-data").textContent);
    const stage = root.querySelector(".pointed");
    const image = stage.querySelector("img");
    const drawing = document.createElementNS(SVG, "svg");
    drawing.setAttribute("viewBox", `-0.5 -0.5 ${size[0]} ${size[1]}`);
    drawing.setAttribute("aria-hidden", "true");
    stage.append(drawing);
    const bar = document.createElement("div");
    bar.className = "tools";
    const select = document.createElement("select");
    select.setAttribute("aria-label", `Point at a place of: ${root.dataset.what}`);
    select.append(new Option("point at …", ""));
    tools.forEach((tool, i) => select.append(new Option(tool.what, String(i))));
    const output = document.createElement("code");
    const note = document.createElement("span");
    const clear = document.createElement("button");
    clear.type = "button";
    clear.textContent = "clear";
    bar.append(select, clear, output, note);
    root.append(bar);

    let places = [];
    const shape = (name, attributes) => {
      const element = document.createElementNS(SVG, name);
      for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
      drawing.append(element);
    };
    const show = () => {
      const tool = tools[Number(select.value)];
      const active = select.value !== "";
      stage.classList.toggle("live", active);
      const answer = active ? told(tool, places, size) : { text: "", note: "" };
      output.textContent = answer.text;
      const left = active ? NEEDED[tool.told] - places.length : 0;
      note.textContent = left > 0 ? `${left} more` : answer.note;
      clear.hidden = places.length === 0;
      drawing.replaceChildren();
      const unit = size[0] / (image.clientWidth || size[0]);
      for (const [x, y] of places) shape("circle", { cx: x, cy: y, r: 4 * unit });
      if (answer.found) shape("circle", { cx: answer.found.cx, cy: answer.found.cy, r: answer.found.r, class: "found" });
    };
    stage.addEventListener("click", (event) => {
      if (select.value === "") return;
      const box = image.getBoundingClientRect();
      const at = [
        (event.clientX - box.left) / box.width * size[0] - 0.5,
        (event.clientY - box.top) / box.height * size[1] - 0.5,
      ];
      const tool = tools[Number(select.value)];
      // A circle and a path take as many places as are given, all else begins anew.
      if (!["circle", "path"].includes(tool.told) && places.length === NEEDED[tool.told]) places = [];
      places.push(at);
      show();
    });
    const anew = () => { places = []; show(); };
    select.addEventListener("change", anew);
    clear.addEventListener("click", anew);
    show();
  };

  for (const root of document.querySelectorAll(".pointing")) start(root);
})();
