(() => {
  "use strict";
  const root = document.documentElement, key = "punchform-theme";
  const stored = () => { try { return localStorage.getItem(key); } catch { return null; } };
  const keep = (theme) => { try { localStorage.setItem(key, theme); } catch { /* a file may have no storage */ } };
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const theme = () => root.dataset.theme || (dark.matches ? "dark" : "light");
  const button = document.getElementById("theme");
  const name = () => { button.textContent = theme() === "dark" ? "Light" : "Dark"; };
  if (["dark", "light"].includes(stored())) root.dataset.theme = stored();
  name();
  button.hidden = false;
  dark.addEventListener("change", name);
  button.addEventListener("click", () => {
    root.dataset.theme = theme() === "dark" ? "light" : "dark";
    keep(root.dataset.theme);
    name();
  });

  const give = (blob, file) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = file;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const TIMES = 3;
  const saved = {
    svg: (image, file) => {
      const text = decodeURIComponent(image.src.slice(image.src.indexOf(",") + 1));
      give(new Blob([text], { type: "image/svg+xml" }), file);
    },
    png: (image, file) => {
      const sheet = document.createElement("canvas"), pen = sheet.getContext("2d");
      sheet.width = TIMES * image.naturalWidth;
      sheet.height = TIMES * image.naturalHeight;
      pen.fillStyle = "#ffffff";
      pen.fillRect(0, 0, sheet.width, sheet.height);
      pen.drawImage(image, 0, 0, sheet.width, sheet.height);
      sheet.toBlob((blob) => give(blob, file), "image/png");
    },
  };
  for (const line of document.querySelectorAll(".save")) {
    line.hidden = false;
    const figure = line.closest("figure");
    for (const one of line.querySelectorAll("button")) {
      const kind = one.dataset.as;
      one.addEventListener("click", () => saved[kind](figure.querySelector("img"), `${figure.id}.${kind}`));
    }
  }
})();
