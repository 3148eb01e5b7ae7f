"use strict";
// A link to a folded part opens it over the place where the reader is, and closing leads back there; without this script
// the browser goes to the part itself.
(() => {
  const dialog = document.createElement("dialog");
  const close = document.createElement("button");
  close.type = "button";
  close.textContent = "close";
  close.addEventListener("click", () => dialog.close());
  // A click beside the dialog falls on the dialog itself.
  dialog.addEventListener("click", (event) => { if (event.target === dialog) dialog.close(); });
  const content = document.createElement("div");
  dialog.append(close, content);
  document.body.append(dialog);

  document.addEventListener("click", (event) => {
    const link = event.target.closest("a");
    const address = link && link.getAttribute("href");
    if (!address || !address.startsWith("#")) return;
    const part = document.getElementById(address.slice(1));
    if (!part || part.localName !== "details") return;
    event.preventDefault();
    content.replaceChildren(...[...part.children].map((child) => child.cloneNode(true)));
    const heading = document.createElement("h3");
    heading.textContent = part.querySelector("summary").textContent;
    content.querySelector("summary").replaceWith(heading);
    dialog.setAttribute("aria-label", heading.textContent);
    dialog.showModal();
    dialog.scrollTop = 0;
  });
})();
