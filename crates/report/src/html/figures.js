"use strict";
// Saves a chart as the SVG file that it is in the page.
(() => {
  for (const chart of document.querySelectorAll("figure > svg")) {
    const link = document.createElement("a");
    link.className = "save";
    link.textContent = "save as SVG";
    const title = chart.querySelector("title").textContent;
    link.download = `${title.replaceAll(/[^\p{L}\p{N}]+/gu, "-")}.svg`;
    link.href = `data:image/svg+xml,${encodeURIComponent(chart.outerHTML)}`;
    chart.closest("figure").append(link);
  }
})();
