/**
 * Which of the names that are not public are there, of viser, Plotly, uPlot and Mantine: one that
 * stays missing for long is reported, and the rest goes on.
 */
window.paminsaSelfTest = (config) => {
  "use strict";
  const { every, send, viewer, search, missingAfter } = config;
  const UNKNOWN = Symbol("unknown"); // nothing here can tell yet
  const onceThere = (selector, test) => (document.querySelector(selector) ? test() : UNKNOWN);
  const features = {
    "graphics card detection (canvas)": () => viewer().canvas,
    "plain background (backgroundMaterial)": () => viewer().backgroundMaterial,
    "rendering on demand (requestRender, __r3f)": () => window.paminsaDrawing?.canDraw(),
    "light before the first picture, pixels of the view (useEnvironment, useDevSettings)": () => {
      const context = window.paminsaContext?.get();
      return context?.useEnvironment && context.useDevSettings;
    },
    "each input's newest value (guiActions, mutable)": () => window.paminsaInputs?.works(),
    "connecting again after a long break (set_server, retry)": () => window.paminsaReconnect?.works(),
    "links in the address (replaceState)": () => {
      const keeps = window.paminsaLinks?.keeps();
      return keeps === null ? UNKNOWN : keeps;
    },
    "layout of inputs (mantine-Flex-root)": () =>
      onceThere("[role=slider]", () => document.querySelector(".mantine-Flex-root")),
    "numbers typed as a whole (mantine-NumberInput-input, __reactFiber, useGuiConfig)": () =>
      onceThere("[role=slider]", () => window.paminsaNumberFields?.works()),
    "clicks on figures (_fullLayout)": () =>
      onceThere(".plot-container.plotly", () =>
        document.querySelector(".js-plotly-plot")?._fullLayout?._plots),
    "places of tooltips (mantine-Tooltip-tooltip)": () =>
      onceThere("[role=tooltip]", () => document.querySelector(".mantine-Tooltip-tooltip")),
    "values typed into the palette (mantine-Spotlight-search)": () =>
      onceThere(".mantine-Spotlight-content", () => document.querySelector(search)),
    "time cursor (uplots)": () => onceThere(".uplot", () => window.__viserTestpoints?.uplots),
  };
  const waited = Object.fromEntries(Object.keys(features).map((name) => [name, 0]));
  every(500, () => {
    const missing = [];
    for (const name of Object.keys(waited)) {
      const found = features[name]();
      if (!found && ++waited[name] > 2 * missingAfter) missing.push(name);
      if (found && found !== UNKNOWN) delete waited[name];
    }
    if (missing.length && send("missing", missing)) for (const name of missing) delete waited[name];
  });
};
