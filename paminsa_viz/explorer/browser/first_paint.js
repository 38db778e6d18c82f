/**
 * Runs in the head of the page, before anything is drawn: a page that will be dark is so at once.
 *
 * viser draws the page light until the server's theme arrives. Till then it is held dark here, if
 * that is what this tab has chosen or what the browser asks for.
 */
(() => {
  "use strict";
  const NAME = "data-mantine-color-scheme";
  const LONGEST = 120000; // a slow page takes long until it has its theme
  const root = document.documentElement;
  let chosen = "";
  try {
    chosen = JSON.parse(sessionStorage.getItem("@STORE@") || "{}").view?.appearance;
  } catch (error) {
    console.warn(error);
  }
  const asked = window.matchMedia("(prefers-color-scheme: dark)").matches;
  if (chosen === "light" || !(asked || chosen === "dark")) return;
  const hold = () => {
    if (root.getAttribute(NAME) !== "dark") root.setAttribute(NAME, "dark");
  };
  const observer = new MutationObserver(hold);
  observer.observe(root, { attributeFilter: [NAME] });
  root.style.colorScheme = "dark";
  hold();
  const release = () => {
    observer.disconnect();
    root.style.colorScheme = "";
  };
  setTimeout(release, LONGEST);
  window.paminsaFirstPaint = { release };
})();
