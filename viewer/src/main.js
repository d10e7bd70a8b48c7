// Every viewer of the page: each element with data-scene shows the scene in the script element of that id.

import { linking } from "./linking.js";
import { mount } from "./viewer.js";

async function mountAll() {
  const group = linking();
  const places = [...document.querySelectorAll(".pf-viewer[data-scene]")];
  for (const root of places) {
    const text = document.getElementById(root.dataset.scene).textContent;
    // The page is shown before work of some tenths of a second begins.
    await new Promise((go) => setTimeout(go, 0));
    try {
      await mount(root, text, group);
    } catch (problem) {
      root.replaceChildren(Object.assign(document.createElement("p"), { className: "pf-message", textContent: `The 3D view could not be made: ${problem.message}.` }));
      console.error(problem);
    }
  }
  const link = document.querySelector(".pf-link input");
  if (link) link.addEventListener("change", () => { group.linked = link.checked; });
}

globalThis.punchformViewer = { mount, linking };
if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", mountAll);
else mountAll();
