"use strict";
// Puts a slider for each parameter over every table of class "explorer" and fills the table with what the surfaces
// predict at their place. The address may name a place, its values in the order of the sliders: report.html#at=0.3,0.4
(() => {
  const DASH = "–";

  // The same sums in the same order as those behind the table in the page, so that both give the same numbers.
  const termOf = (powers, coded) => powers.reduce((product, power, j) => {
    let factor = 1;
    for (let i = 0; i < power; i += 1) factor *= coded[j];
    return product * factor;
  }, 1);
  const sum = (numbers) => numbers.reduce((total, number) => total + number, 0);

  const predict = (surface, values) => {
    const coded = surface.parameters.map((j, i) => (values[j] - surface.middle[i]) / surface.half[i]);
    const row = surface.powers.map((powers) => termOf(powers, coded));
    const mean = sum(row.map((x, i) => x * surface.coefficients[i]));
    const leverage = sum(row.map((x, i) => (
      x * sum(row.map((y, j) => y * surface.covariance_over_variance[i][j])))));
    const error = (share) => (
      surface.error_variance === null ? null : Math.sqrt(surface.error_variance * share));
    const interval = (se) => (se === null || surface.t_limit === null
      ? null : [mean - surface.t_limit * se, mean + surface.t_limit * se]);
    const seMean = error(leverage);
    const beyond = coded.some((x) => Math.abs(x) > 1 + 1e-9);
    return { mean, seMean, mean95: interval(seMean), new95: interval(error(1 + leverage)), beyond };
  };

  const signed = (text) => (/^[-+]?[0.]*$/.test(text) ? text.replace(/^[-+]/, "") : text.replace("-", "−"));
  const inUnit = (text, unit) => (unit === "" ? text : unit === "°" ? `${text}°` : `${text} ${unit}`);

  const element = (name, className, text) => {
    const made = document.createElement(name);
    made.className = className;
    if (text) made.textContent = text;
    return made;
  };

  const fillRow = (row, surface, values) => {
    const told = predict(surface, values);
    const number = (value) => signed(value.toFixed(surface.decimals));
    const ends = (pair) => (pair ? inUnit(`${number(pair[0])} to ${number(pair[1])}`, surface.unit) : DASH);
    const cell = (name) => row.querySelector(`td.${name}`);
    cell("mean").textContent = inUnit(number(told.mean), surface.unit);
    cell("mean95").textContent = ends(told.mean95);
    cell("new95").textContent = ends(told.new95);
    // All digits, for those who read the page by program.
    row.dataset.mean = told.mean;
    row.dataset.mean95 = told.mean95 || "";
    row.dataset.new95 = told.new95 || "";
    const [low, high] = surface.axis;
    const width = row.querySelector("svg").viewBox.baseVal.width;
    const place = (value) => Math.min(width, Math.max(0, width * (value - low) / (high - low)));
    for (const name of ["mean95", "new95"]) {
      const [from, to] = told[name] || [told.mean, told.mean];
      const bar = row.querySelector(`rect.${name}`);
      bar.setAttribute("x", place(from));
      bar.setAttribute("width", Math.max(1.5, place(to) - place(from)));
    }
    const target = surface.measured;
    const isInside = target && told.new95 && told.new95[0] <= target.mean && target.mean <= told.new95[1];
    // A table without measurements has no columns for them.
    if (cell("inside")) {
      cell("inside").textContent = target && told.new95 ? (isInside ? "yes" : "no") : DASH;
    }
    const z = target && told.seMean !== null
      ? (target.mean - told.mean) / Math.hypot(target.se, told.seMean) : NaN;
    if (cell("z")) {
      cell("z").textContent = Number.isFinite(z) ? signed((z > 0 ? "+" : "") + z.toFixed(1)) : DASH;
    }
    row.classList.toggle("outside", Boolean(target && told.new95 && !isInside));
    return told.beyond;
  };

  const start = (box) => {
    const { parameters, places, surfaces } = JSON.parse(box.querySelector("script.surfaces").textContent);
    const rows = [...box.querySelectorAll("tbody tr")];
    const values = [...places[0].values];
    const sliders = element("div", "sliders");
    const note = element("p", "beyond");
    note.setAttribute("role", "status");

    const fill = () => {
      const beyond = surfaces.map((surface, i) => fillRow(rows[i], surface, values)).some(Boolean);
      note.textContent = beyond ? "Outside the ranges of the runs behind a surface: it was not made there." : "";
    };
    const inputs = parameters.map((parameter, j) => {
      const line = element("div", "slider");
      const title = [parameter.symbol, parameter.name].filter(Boolean).join(" ");
      const label = element("label", "", parameter.unit ? `${title} (${parameter.unit})` : title);
      const [range, number] = ["range", "number"].map((type) => {
        const input = element("input", type);
        Object.assign(input, { type, min: parameter.low, max: parameter.high, step: "any" });
        input.setAttribute("aria-label", label.textContent);
        return input;
      });
      const show = () => {
        range.value = values[j];
        number.value = Number(values[j].toPrecision(6));
      };
      const take = (input) => {
        const value = input.valueAsNumber;
        if (!Number.isFinite(value)) return;
        values[j] = value;
        fill();
      };
      range.addEventListener("input", () => {
        take(range);
        number.value = Number(values[j].toPrecision(6));
      });
      number.addEventListener("input", () => {
        take(number);
        range.value = values[j];
      });
      label.append(range);
      line.append(label, number);
      sliders.append(line);
      return show;
    });
    const moveTo = (wanted) => {
      wanted.forEach((value, j) => { values[j] = value; });
      inputs.forEach((show) => show());
      fill();
    };
    const buttons = element("div", "places");
    for (const place of places) {
      const button = element("button", "", place.name);
      button.type = "button";
      button.addEventListener("click", () => moveTo(place.values));
      buttons.append(button);
    }
    const moveToAddress = () => {
      const named = /^#at=(.*)$/.exec(location.hash);
      const wanted = named && named[1].split(",").map(Number);
      if (wanted && wanted.length === values.length && wanted.every(Number.isFinite)) moveTo(wanted);
    };
    sliders.append(buttons, note);
    box.prepend(sliders);
    moveTo(values);
    window.addEventListener("hashchange", moveToAddress);
    moveToAddress();
  };

  for (const box of document.querySelectorAll(".explorer")) start(box);
})();
