// The colours of the page's theme, read from its style, and told again when the theme changes.

const NAMES = ["stage", "missing", "punch", "target", "family1", "family2"];

/** The colours of an element's theme; `changed` is called when the page or the system takes another. */
export function watchTheme(root, changed) {
  const theme = { colours: {}, ground: "light", read };
  function read() {
    const style = getComputedStyle(root);
    theme.colours = Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--pf-${name}`)]));
    theme.ground = style.getPropertyValue("--pf-ground").trim() === "dark" ? "dark" : "light";
  }
  function again() {
    read();
    changed();
  }
  read();
  new MutationObserver(again).observe(document.documentElement, { attributes: true, attributeFilter: ["data-theme"] });
  for (const asked of ["(prefers-color-scheme: dark)", "print"]) window.matchMedia(asked).addEventListener("change", again);
  return theme;
}
