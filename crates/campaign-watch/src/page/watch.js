"use strict";
// Fetches the parts of the page every two seconds and replaces those that are new. Their texts are escaped where they are made.
(() => {
  const shown = new Map();
  const lost = document.getElementById("lost");
  async function renew() {
    try {
      const reply = await fetch("data.json", { cache: "no-store", credentials: "omit" });
      if (!reply.ok) throw new Error(String(reply.status));
      const data = await reply.json();
      for (const [name, markup] of Object.entries(data.parts)) {
        const element = document.getElementById(name);
        if (element && shown.get(name) !== markup) {
          element.innerHTML = markup;
          shown.set(name, markup);
        }
      }
      document.title = data.title;
      lost.hidden = true;
    } catch {
      lost.hidden = false;
    }
    setTimeout(renew, 2000);
  }
  setTimeout(renew, 2000);
})();
