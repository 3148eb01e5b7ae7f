"use strict";
// Says how old the page is when nobody has renewed it for three minutes.
(() => {
  const minutes = (Date.now() - Date.parse(document.lastModified)) / 60000;
  if (!(minutes > 3)) return;
  const box = document.querySelector("#age");
  box.querySelector("strong").textContent = `Last written ${Math.round(minutes)} minutes ago`;
  box.querySelector("p").textContent = "Unless this is a copy, the program has ended or its machine is out of reach: "
    + "finished runs are kept, and the same command with --resume goes on.";
  box.hidden = false;
})();
