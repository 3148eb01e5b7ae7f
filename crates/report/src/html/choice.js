"use strict";
// Shows one chart at a time of every element of class "choice", by a list over them.
(() => {
  const start = (box) => {
    const parts = [...box.querySelectorAll(":scope > [data-name]")];
    if (parts.length < 2) return;
    const label = document.createElement("label");
    const list = document.createElement("select");
    label.append(`${box.dataset.what} `, list);
    parts.forEach((part, i) => list.add(new Option(part.dataset.name, i)));
    const show = () => parts.forEach((part, i) => { part.hidden = i !== list.selectedIndex; });
    list.addEventListener("change", show);
    box.prepend(label);
    show();
  };

  for (const box of document.querySelectorAll(".choice")) start(box);
})();
