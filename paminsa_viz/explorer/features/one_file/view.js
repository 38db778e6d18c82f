/** Looking at the robot, and moving it by the handle, with the mouse, fingers and keys. */
const PRESETS = { "3D": [-52, 15], Top: [-90, 89.9], Front: [-90, 4], Side: [0, 4] }; // degrees

/**
 * Make the view of the robot on a canvas. `shown` gives what is drawn: robot and pose; `request`
 * asks for a picture, `move` changes coordinates of the pose, `release` ends a change.
 */
const createView = (canvas, { shown, request, move, release }) => {
  const scene = createScene(canvas, request);
  let view = null;
  let chosen = PRESETS["3D"]; // null once the person has turned the view
  let fittedFor = "";
  let camera = null;
  let held = null; // what the handle does, and where it was taken
  const fingers = new Map();

  const look = (preset) => {
    chosen = PRESETS[preset];
    fittedFor = "";
    request();
  };
  const turn = (dx, dy) => {
    chosen = null;
    const most = Math.PI / 2 - 1e-3;
    view = { ...view, azimuth: view.azimuth + dx,
      elevation: Math.max(-most, Math.min(most, view.elevation + dy)) };
    request();
  };
  const zoom = (factor) => {
    chosen = null;
    const distance = Math.max(0.06 * view.size, Math.min(20 * view.size, view.distance * factor));
    view = { ...view, distance };
    request();
  };
  const pan = (dx, dy) => {
    chosen = null;
    const size = view.distance / (camera.pixels * canvas.clientHeight);
    view = { ...view, look: view.look.map((part, axis) =>
      part + size * (dy * camera.up[axis] - dx * camera.right[axis])) };
    request();
  };

  // --- the handle: rays into the scene --------------------------------------------------------
  const inPicture = (event) => {
    const box = canvas.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  };
  const center = () => {
    const { robot, pose } = shown();
    return [pose[0], pose[1], pose[3] + robot.mechanism.joint_height];
  };
  const onHandle = (event) => {
    if (!camera || !shown()) return false;
    const box = canvas.getBoundingClientRect();
    const at = pictured(camera, center());
    return Math.hypot(event.clientX - box.left - at[0] * box.width,
      event.clientY - box.top - at[1] * box.height) < 1.5 * HANDLE_SIZE;
  };
  /** Return where a pointer's ray meets the plane through a point across a direction, or null. */
  const onPlane = (event, point, normal) => {
    const [u, v] = inPicture(event);
    const t = Math.tan(FIELD_OF_VIEW / 2);
    const ray = [0, 1, 2].map((axis) => -camera.back[axis]
      + (2 * u - 1) * t * camera.aspect * camera.right[axis] + (1 - 2 * v) * t * camera.up[axis]);
    const slope = dot(ray, normal);
    const far = dot(point.map((part, axis) => part - camera.eye[axis]), normal) / slope;
    if (!(far > 0) || Math.abs(slope) < 0.02) return null;
    return camera.eye.map((part, axis) => part + far * ray[axis]);
  };
  const take = (event) => {
    const kind = event.shiftKey ? "z" : event.altKey || event.ctrlKey ? "theta" : "xy";
    const level = [Math.cos(view.azimuth), Math.sin(view.azimuth), 0];
    const normal = kind === "z" ? level : [0, 0, 1];
    const from = onPlane(event, center(), normal);
    if (from) held = { kind, normal, from, center: center(), pose: shown().pose };
  };
  const drag = (event) => {
    const { kind, normal, from, center: middle, pose } = held;
    const to = onPlane(event, middle, normal);
    if (!to) return;
    const round = (value) => Number(value.toFixed(6));
    if (kind === "z") move({ 3: round(pose[3] + to[2] - from[2]) });
    else if (kind === "xy")
      move({ 0: round(pose[0] + to[0] - from[0]), 1: round(pose[1] + to[1] - from[1]) });
    else {
      const angle = (point) => Math.atan2(point[1] - middle[1], point[0] - middle[0]);
      const turned = pose[2] + angle(to) - angle(from);
      move({ 2: round(Math.atan2(Math.sin(turned), Math.cos(turned))) });
    }
  };

  if (scene) {
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, event);
      if (event.button === 0 && fingers.size === 1 && onHandle(event)) take(event);
      request();
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (!before) {
        canvas.style.cursor = onHandle(event) ? "move" : "grab";
        return;
      }
      const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
      const other = [...fingers.values()].find((each) => each.pointerId !== event.pointerId);
      if (held) drag(event);
      else if (other) {
        const apart = (each) => Math.hypot(each.clientX - other.clientX, each.clientY - other.clientY);
        zoom(Math.max(apart(before), 1) / Math.max(apart(event), 1));
        pan(dx / 2, dy / 2);
      } else if (event.buttons & 1) turn(-0.008 * dx, 0.008 * dy);
      else pan(dx, dy);
      fingers.set(event.pointerId, event);
    });
    for (const name of ["pointerup", "pointercancel"])
      canvas.addEventListener(name, (event) => {
        fingers.delete(event.pointerId);
        if (held) release();
        held = null;
        request();
      });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      zoom(Math.exp(0.0012 * event.deltaY * (event.deltaMode ? 30 : 1)));
    }, { passive: false });
    canvas.addEventListener("dblclick", () => look("3D"));
    const keys = {
      ArrowLeft: () => turn(0.1, 0), ArrowRight: () => turn(-0.1, 0),
      ArrowUp: () => turn(0, 0.1), ArrowDown: () => turn(0, -0.1),
      "+": () => zoom(0.9), "-": () => zoom(1 / 0.9), Home: () => look("3D"),
    };
    canvas.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });
  }

  /** Draw what is shown with what lies on the floor; a view that was chosen fits the robot. */
  const draw = (scenery) => {
    if (!scene || !canvas.clientHeight) return;
    const aspect = canvas.clientWidth / canvas.clientHeight;
    const { robot } = shown();
    const key = JSON.stringify([robot.mechanism, robot.guide, robot.scale, aspect]);
    if (chosen && key !== fittedFor) {
      fittedFor = key;
      view = fittedView(robot, ...chosen.map((part) => part * Math.PI / 180), aspect);
    }
    const moving = scenery.moving || fingers.size > 0;
    camera = scene.draw({ ...shown(), ...scenery, view, held, moving }) ?? camera;
  };
  /** Return where the handle is in the picture, as shares of its size from the upper left. */
  const handlePlace = () => pictured(camera, center()).slice(0, 2);
  return { draw, look, handlePlace, isMissing: !scene };
};
