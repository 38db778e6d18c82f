/**
 * Runs in the head of the page: how the 3D view is drawn, above all where a program stands for the
 * graphics card, which then takes most of the machine.
 *
 * There the canvas is opaque and shows the backdrop itself. An edge is smoothed only while nothing
 * moves: several samples for every pixel, as viser asks for, cost more than the robot in each picture
 * of a drag. They are taken in a buffer beside the canvas, which keeps its size: another size would
 * make the first picture of a drag late.
 */
(() => {
  "use strict";
  const PROGRAMS = /@PROGRAMS@/i;
  const BACKDROPS = @BACKDROPS@; // of the light and of the dark theme: top and bottom [0 to 1]
  const SAMPLES = 4; // for each pixel of a smooth picture
  const MOST_PIXELS = 2; // for one of the page's
  const STILL_AFTER = 400; // without a change [ms]
  const ANIMATED_PERIOD = 125; // between two pictures of an endless animation [ms]

  const getContext = HTMLCanvasElement.prototype.getContext;
  let renderer = null;
  /** What draws, as the browser names it; empty if it does not say. */
  const named = () => {
    if (renderer !== null) return renderer;
    const gl = getContext.call(document.createElement("canvas"), "webgl2");
    const names = gl?.getExtension("WEBGL_debug_renderer_info");
    // Firefox says it without that extension, which it will remove.
    renderer = gl ? String(gl.getParameter(names?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER)) : "";
    gl?.getExtension("WEBGL_lose_context")?.loseContext();
    return renderer;
  };
  HTMLCanvasElement.prototype.getContext = function (kind, options, ...rest) {
    if (kind !== "webgl2" || !PROGRAMS.test(named())) {
      return getContext.call(this, kind, options, ...rest);
    }
    const gl = getContext.call(this, kind, { ...options, antialias: false, alpha: false }, ...rest);
    return gl && !Object.hasOwn(gl, "clear") ? withBackdrop(gl) : gl;
  };

  let isCapture = false; // the picture is one to be saved
  let standIn = null; // a buffer that is drawn to in place of the canvas
  const scheme = () => document.documentElement.getAttribute("data-mantine-color-scheme");
  const backdrop = () => BACKDROPS[scheme()] ?? BACKDROPS.light;
  const mixed = ([top, bottom], share) => top.map((v, i) => v + (bottom[i] - v) * share);
  /**
   * Let a context draw the backdrop where the scene is clear. Its canvas is opaque: what lies below
   * another the browser draws as well, and puts the two together, with every picture of the page.
   */
  const withBackdrop = (gl) => {
    const { clear, clearColor, bindFramebuffer, viewport } = Object.getPrototypeOf(gl);
    const { canvas, COLOR_BUFFER_BIT } = gl;
    let color = [0, 0, 0, 0];
    let isView = true; // what is drawn to now; asking the context would wait for all that it draws
    gl.clearColor = (...rgba) => {
      color = rgba;
      clearColor.call(gl, ...rgba);
    };
    gl.bindFramebuffer = (target, buffer) => {
      if (target !== gl.READ_FRAMEBUFFER) isView = !buffer;
      bindFramebuffer.call(gl, target, buffer ?? standIn);
    };
    /** Fill the view with the gradient of saved pictures, a row of pixels at a time. */
    const fillRows = () => {
      const { width, height } = canvas;
      const area = gl.getParameter(gl.SCISSOR_BOX);
      gl.enable(gl.SCISSOR_TEST);
      for (let row = 0; row < height; row++) {
        gl.scissor(0, row, width, 1);
        clearColor.call(gl, ...mixed(BACKDROPS.light, 1 - row / Math.max(height - 1, 1)), 1);
        clear.call(gl, COLOR_BUFFER_BIT);
      }
      gl.disable(gl.SCISSOR_TEST);
      gl.scissor(...area);
    };
    gl.clear = (what) => {
      if (!isView || !(what & COLOR_BUFFER_BIT) || color[3] > 0) return clear.call(gl, what);
      if (isCapture) fillRows();
      else clearColor.call(gl, ...mixed(backdrop(), 0.5), 1);
      clear.call(gl, isCapture ? what & ~COLOR_BUFFER_BIT : what);
      clearColor.call(gl, ...color);
    };
    // A canvas of another size is black until the scene is drawn.
    let size = "";
    gl.viewport = (...area) => {
      viewport.call(gl, ...area);
      const found = `${canvas.width} ${canvas.height}`;
      if (found !== size) gl.clear(COLOR_BUFFER_BIT);
      size = found;
    };
    gl.clear(COLOR_BUFFER_BIT);
    return gl;
  };

  // The light is the explorer's own: viser's lamps and its picture of the surroundings would be
  // prepared for the first picture and thrown away with the second. Without a graphics card the view
  // has a pixel for one of the page's, and all that the screen has only at rest, unless the address
  // asks for a number.
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

  /**
   * Return a function that calls `draw` with several samples for each pixel: what would go to the
   * canvas goes to a buffer of its size, and from there to the canvas.
   */
  const smoother = (gl) => {
    const { canvas } = gl;
    const samples = Math.min(SAMPLES, gl.getParameter(gl.MAX_SAMPLES));
    let kept = null;
    canvas.addEventListener("webglcontextrestored", () => (kept = null));
    const attach = (place, format) => {
      const storage = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, storage);
      gl.renderbufferStorageMultisample(
        gl.RENDERBUFFER, samples, format, canvas.width, canvas.height,
      );
      gl.bindRenderbuffer(gl.RENDERBUFFER, null);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, storage);
      return storage;
    };
    /** Make what is drawn to; it has to be made anew with every size of the canvas. */
    const make = () => {
      kept?.storages.forEach((storage) => gl.deleteRenderbuffer(storage));
      const buffer = kept?.buffer ?? gl.createFramebuffer();
      gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
      const storages = [
        attach(gl.COLOR_ATTACHMENT0, gl.RGB8), attach(gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24),
      ];
      const isWhole = gl.checkFramebufferStatus(gl.FRAMEBUFFER) === gl.FRAMEBUFFER_COMPLETE;
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      kept = { buffer, storages, isWhole, width: canvas.width, height: canvas.height };
    };
    return (draw) => {
      if (kept?.width !== canvas.width || kept.height !== canvas.height) make();
      const { buffer, isWhole, width, height } = kept;
      if (!isWhole) return draw();
      standIn = buffer;
      try {
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        draw();
      } finally {
        standIn = null;
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, buffer);
        gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
        const all = [0, 0, width, height];
        gl.blitFramebuffer(...all, ...all, gl.COLOR_BUFFER_BIT, gl.NEAREST);
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      }
    };
  };

  const viewer = () => window.__viserMutable || {};
  const drawn = () => viewer().scene?.__r3f?.root?.getState?.();
  const invalidator = () => drawn()?.invalidate;
  let isStill = false;
  const smoothed = new WeakSet();
  /** Draw smooth pictures while nothing moves, and for every other camera than the view's own. */
  const smoothStills = () => {
    const { gl: renderer, get } = drawn();
    const context = renderer.getContext();
    const { antialias, alpha } = context.getContextAttributes() ?? {};
    if (antialias || alpha || smoothed.has(renderer)) return;
    smoothed.add(renderer);
    const render = renderer.render.bind(renderer);
    const smoothly = smoother(context);
    renderer.render = (scene, camera) => {
      isCapture = camera !== get().camera;
      const isSmooth = (isStill || isCapture) && !renderer.getRenderTarget();
      if (isSmooth) smoothly(() => render(scene, camera));
      else render(scene, camera);
      isCapture = false;
    };
  };
  /**
   * Draw the scene once for a change, and once more when nothing has changed for a while: viser
   * draws it over and over for a quarter of a second, and the next change has to wait. `animation`
   * is the place of what requests pictures without end: some are drawn every second, no more.
   */
  const renderOnDemand = (animation) => {
    if (!viewer().requestRender || !invalidator()) return;
    smoothStills();
    let timer = 0;
    let at = 0;
    const draw = (still) => {
      at = performance.now();
      isStill = still;
      setPixels(still ? Math.min(window.devicePixelRatio, MOST_PIXELS) : 1);
      invalidator()();
    };
    const animated = () => viewer().nodeRefFromName?.[animation];
    viewer().requestRender = () => {
      const wait = animated() ? Math.max(0, at + ANIMATED_PERIOD - performance.now()) : 0;
      if (wait && timer) return;
      clearTimeout(timer);
      const last = () => ((timer = 0), draw(!wait));
      timer = setTimeout(last, wait || STILL_AFTER);
      if (!wait) draw(false);
    };
  };
  window.paminsaDrawing = { renderOnDemand, named, canDraw: () => viewer().requestRender && invalidator() };
})();
