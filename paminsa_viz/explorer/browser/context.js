/**
 * Runs in the head of the page: finds viser's own context, with the inputs by their uuid, the
 * settings and the connection. No name of the window leads to it, but React keeps it beside what it
 * has drawn. It is there before the 3D view and the inputs are.
 */
(() => {
  "use strict";
  /** The first value that `get` finds in the properties of what a page's element was drawn by. */
  const find = (element, get) => {
    const key = Object.keys(element ?? {}).find((name) => name.startsWith("__reactFiber$"));
    for (let fiber = key && element[key]; fiber; fiber = fiber.return) {
      const found = get(fiber.memoizedProps ?? {});
      if (found) return found;
    }
    return undefined;
  };

  let context = null;
  const waiting = [];
  const look = () => {
    const canvas = document.querySelector("#root canvas");
    context = find(canvas, ({ value }) => value?.useGuiConfig && value) ?? null;
    if (!context) return;
    observer.disconnect();
    for (const call of waiting.splice(0)) call(context);
  };
  const observer = new MutationObserver(look);
  observer.observe(document, { childList: true, subtree: true });

  /** Call a function with the context once it is there. */
  const whenFound = (call) => {
    if (context) call(context);
    else waiting.push(call);
  };
  window.paminsaContext = { find, whenFound, get: () => context };
})();
