/**
 * Runs in the head of the page: how the 3D view is drawn, above all where a program stands for the
 * graphics card, which then takes most of the machine.
 *
 * There an edge is smoothed by twice the pixels, and only while nothing moves: several samples for
 * every pixel, as viser asks for, cost more than the robot in each picture of a drag.
 */
(() => {
  "use strict";
  const PROGRAMS = /@PROGRAMS@/i;
  const STILL_PIXELS = 2; // for one of the page's
  const STILL_AFTER = 400; // without a change [ms]
  const ANIMATED_PERIOD = 125; // between two pictures of an endless animation [ms]

  const getContext = HTMLCanvasElement.prototype.getContext;
  let renderer = null;
  /** What draws, as the browser names it; empty if it does not say. */
  const named = () => {
    if (renderer !== null) return renderer;
    const gl = getContext.call(document.createElement("canvas"), "webgl2");
    const names = gl?.getExtension("WEBGL_debug_renderer_info");
    renderer = names ? String(gl.getParameter(names.UNMASKED_RENDERER_WEBGL)) : "";
    gl?.getExtension("WEBGL_lose_context")?.loseContext();
    return renderer;
  };
  HTMLCanvasElement.prototype.getContext = function (kind, options, ...rest) {
    const isPlain = kind === "webgl2" && PROGRAMS.test(named());
    const chosen = isPlain ? { ...options, antialias: false } : options;
    return getContext.call(this, kind, chosen, ...rest);
  };

  // The light is the explorer's own: viser's lamps and its picture of the surroundings would be
  // prepared for the first picture and thrown away with the second. A number of pixels that the
  // address asks for stays.
  let setPixels = () => {};
  window.paminsaContext.whenFound((context) => {
    context.useEnvironment?.set({
      enableDefaultLights: false,
      environmentMap: {
        type: "EnvironmentMapMessage", hdri_data: null, background: false, background_blurriness: 0,
        background_intensity: 1, background_wxyz: [1, 0, 0, 0], environment_intensity: 1,
        environment_wxyz: [1, 0, 0, 0],
      },
    });
    const settings = context.useDevSettings;
    if (!settings || settings.get().fixedDpr !== null || !PROGRAMS.test(named())) return;
    setPixels = (fixedDpr) => settings.set({ fixedDpr });
    setPixels(1);
  });

  const viewer = () => window.__viserMutable || {};
  const invalidator = () => viewer().scene?.__r3f?.root?.getState?.()?.invalidate;
  /**
   * Draw the scene once for a change, and once more when nothing has changed for a while: viser
   * draws it over and over for a quarter of a second, and the next change has to wait. `animation`
   * is the place of what requests pictures without end: some are drawn every second, no more.
   */
  const renderOnDemand = (animation) => {
    document.documentElement.classList.add("paminsa-render-on-demand");
    if (!viewer().requestRender || !invalidator()) return;
    let timer = 0;
    let drawn = 0;
    const draw = (pixels) => {
      drawn = performance.now();
      setPixels(pixels);
      invalidator()();
    };
    const animated = () => viewer().nodeRefFromName?.[animation];
    viewer().requestRender = () => {
      const wait = animated() ? Math.max(0, drawn + ANIMATED_PERIOD - performance.now()) : 0;
      if (wait && timer) return;
      clearTimeout(timer);
      const last = () => ((timer = 0), draw(wait ? 1 : STILL_PIXELS));
      timer = setTimeout(last, wait || STILL_AFTER);
      if (!wait) draw(1);
    };
  };
  window.paminsaDrawing = { renderOnDemand, named, canDraw: () => viewer().requestRender && invalidator() };
})();
