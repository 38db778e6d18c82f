/**
 * Widens the view in a window that is too narrow for the robot; the camera is placed for a wide one.
 *
 * Viser sets its own angle of view once the scene is there, at a time that is not told, and keeps
 * no horizontal one: it is looked at again and again.
 */
(() => {
  const LEAST_ASPECT = @ASPECT@; // width over height in which the robot is whole
  const HALF = @HALF@; // tangent of half the vertical angle of view of a wide window
  setInterval(() => {
    const { camera, requestRender } = window.__viserMutable ?? {};
    if (!camera || !requestRender) return;
    const half = HALF * Math.max(1, (LEAST_ASPECT * window.innerHeight) / window.innerWidth);
    const degrees = (360 / Math.PI) * Math.atan(half);
    if (Math.abs(camera.fov - degrees) < 1e-3) return;
    camera.fov = degrees;
    camera.updateProjectionMatrix();
    requestRender();
  }, 100);
})();
