/**
 * The robot in WebGL2, drawn when asked: bodies, a map on the floor, the workspace's circle and the
 * handle on the platform. Matrices are 16 numbers, column by column; lengths are in meters.
 */
const FIELD_OF_VIEW = Math.PI * 32 / 180;
const FLOOR_GAP = 0.0015; // pictures on the floor lie that much over it, times the size of the bodies
const HANDLE_SIZE = 34; // radius of the handle [px]
const SHARPNESS = 2; // least pixels of the picture for a pixel of the page, so that edges are smooth

const SOLID_POINTS = `#version 300 es
in vec3 point; in vec3 normal; in float material;
uniform mat4 camera, body;
out vec3 place, across; flat out int kind;
void main() {
  vec4 world = body * vec4(point, 1.0);
  place = world.xyz;
  across = mat3(body) * normal;
  kind = int(material + 0.5);
  gl_Position = camera * world;
}`;

// Light from above and below, two lamps and their gloss, as the served page has them.
const SOLID_COLORS = `#version 300 es
precision highp float;
in vec3 place, across; flat in int kind;
uniform vec4 colors[16]; // linear color; 0 for what shows its color as it is
uniform vec2 surfaces[16]; // metallic, roughness
uniform vec3 eye;
out vec4 seen;
const vec3 LAMPS[2] = vec3[](vec3(0.395, -0.543, 0.741), vec3(-0.848, -0.509, 0.170));
const float POWER[2] = float[](0.70, 0.24);
void main() {
  vec3 color = colors[kind].rgb;
  if (colors[kind].a > 0.5) {
    vec3 n = normalize(gl_FrontFacing ? across : -across);
    vec3 back = normalize(eye - place);
    float metal = surfaces[kind].x, rough = surfaces[kind].y;
    float sharp = 2.0 / (rough * rough * rough * rough) - 2.0;
    vec3 light = mix(vec3(0.21, 0.225, 0.25), vec3(0.56), 0.5 + 0.5 * n.z);
    vec3 gloss = vec3(0.0);
    vec3 mirrored = mix(vec3(0.04), color, metal);
    for (int lamp = 0; lamp < 2; lamp++) {
      float facing = max(dot(n, LAMPS[lamp]), 0.0);
      light += POWER[lamp] * facing;
      float half_way = max(dot(n, normalize(LAMPS[lamp] + back)), 0.0);
      gloss += POWER[lamp] * facing * mirrored * (sharp + 2.0) / 8.0 * pow(half_way, sharp);
    }
    color = color * (1.0 - 0.6 * metal) * light + gloss;
  }
  seen = vec4(pow(min(color, vec3(1.0)), vec3(1.0 / 2.2)), 1.0);
}`;

const FLAT_POINTS = `#version 300 es
in vec3 point;
uniform mat4 camera, body;
out vec2 place;
void main() {
  place = point.xy;
  gl_Position = camera * body * vec4(point, 1.0);
}`;

const FLAT_COLORS = `#version 300 es
precision highp float;
in vec2 place;
uniform vec4 color; // as seen
uniform int kind; // 0 one color, 1 the picture, 2 a soft spot
uniform sampler2D picture;
out vec4 seen;
void main() {
  seen = color;
  if (kind == 1) seen = texture(picture, vec2(0.5 + 0.5 * place.x, 0.5 - 0.5 * place.y));
  if (kind == 2) seen.a *= pow(max(1.0 - dot(place, place), 0.0), 2.0);
  seen.rgb *= seen.a;
}`;

/** Return what draws: the graphics card, or a program. Chromium tells it by an extension alone. */
const rendererOf = (gl) => {
  const told = gl.getParameter(gl.RENDERER);
  const more = /^webkit/i.test(told) && gl.getExtension("WEBGL_debug_renderer_info");
  return more ? gl.getParameter(more.UNMASKED_RENDERER_WEBGL) : told;
};

/** Return points of a flat ring about z with radius 1, as a strip. */
const ringPoints = (width, from = 0, to = 2 * Math.PI) => {
  const points = [];
  for (let step = 0; step <= 96; step++) {
    const angle = from + (to - from) * step / 96;
    for (const radius of [1 - width, 1])
      points.push(radius * Math.cos(angle), radius * Math.sin(angle), 0);
  }
  return points;
};

/** Return four arrowheads along +x, +y, -x and -y around a circle of radius 1, as triangles. */
const arrowPoints = () => [0, 1, 2, 3].flatMap((quarter) => {
  const [c, s] = [[1, 0], [0, 1], [-1, 0], [0, -1]][quarter];
  return [[1.08, -0.2], [1.48, 0], [1.08, 0.2]].flatMap(([x, y]) => [c * x - s * y, s * x + c * y, 0]);
});

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** Return the camera of a view: its place, its axes and its matrix. */
const cameraOf = (view, aspect) => {
  const [ca, sa, ce, se] = [
    Math.cos(view.azimuth), Math.sin(view.azimuth), Math.cos(view.elevation), Math.sin(view.elevation),
  ];
  const back = [ce * ca, ce * sa, se];
  const right = [-sa, ca, 0];
  const up = [-se * ca, -se * sa, ce];
  const eye = view.look.map((part, axis) => part + view.distance * back[axis]);
  const far = view.distance + 2 * view.size;
  const near = Math.max(view.distance - 2 * view.size, far / 1000);
  const f = 1 / Math.tan(FIELD_OF_VIEW / 2);
  const depth = (far + near) / (far - near);
  const rows = [
    [...right.map((part) => part * f / aspect), -f / aspect * dot(right, eye)],
    [...up.map((part) => part * f), -f * dot(up, eye)],
    [...back.map((part) => -part * depth), depth * dot(back, eye) - 2 * far * near / (far - near)],
    [...back.map((part) => -part), dot(back, eye)],
  ];
  const matrix = [0, 1, 2, 3].flatMap((column) => rows.map((row) => row[column]));
  return { matrix, eye, back, right, up, aspect, pixels: f / 2 };
};

/** Return where a point is in a picture, as shares of its width and height from the upper left. */
const pictured = (camera, point) => {
  const [x, y, , w] = [0, 1, 2, 3].map((row) =>
    [...point, 1].reduce((sum, part, column) => sum + part * camera.matrix[4 * column + row], 0));
  return [0.5 + 0.5 * x / w, 0.5 - 0.5 * y / w, w];
};

/** Return points around the whole machine. */
const outlineOf = (robot) => {
  const m = robot.drawn;
  const guide = robot.guide / robot.scale;
  const frame = paminsaFrameLengths(m, guide);
  const reach = m.base_radius + Math.max(guide, m.crank) + 0.02;
  const rings = [
    [reach, 0], [reach, -m.root * m.crank], [frame.plinth_radius, frame.ground - 0.02],
    [0.04, Math.max(frame.column_top, frame.mast_top) + 0.2],
  ];
  return rings.flatMap(([radius, height]) => Array.from({ length: 24 }, (_, index) =>
    [radius * Math.cos(index * Math.PI / 12), radius * Math.sin(index * Math.PI / 12), height]
      .map((each) => each * robot.scale)));
};

/** Return a view from a direction [rad] that just holds the machine, in the middle of the picture. */
const fittedView = (robot, azimuth, elevation, aspect) => {
  const points = outlineOf(robot);
  const { right, up, back } = cameraOf(
    { azimuth, elevation, look: [0, 0, 0], distance: 1, size: 1 }, aspect);
  const tangent = 0.94 * Math.tan(FIELD_OF_VIEW / 2);
  let look = [0, 1, 2].map((axis) =>
    points.reduce((sum, point) => sum + point[axis], 0) / points.length);
  const size = Math.max(...points.map((point) => Math.hypot(...point)));
  let distance = 1;
  for (let round = 0; round < 12; round++) {
    const local = points.map((point) => {
      const from = point.map((part, axis) => part - look[axis]);
      return [dot(from, right), dot(from, up), dot(from, back)];
    });
    distance = Math.max(...local.map(([x, y, z]) =>
      Math.max(Math.abs(x) / aspect, Math.abs(y)) / tangent + z));
    const seen = local.map(([, y, z]) => y / (distance - z));
    const middle = (Math.max(...seen) + Math.min(...seen)) / 2 * distance;
    look = look.map((part, axis) => part + middle * up[axis]);
  }
  return { azimuth, elevation, look, distance, size: size + Math.hypot(...look) };
};

/** Return a linked program with the places of its uniforms by name. */
const programOf = (gl, points, colors, attributes) => {
  const linked = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, points], [gl.FRAGMENT_SHADER, colors]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(linked, shader);
  }
  attributes.forEach((name, index) => gl.bindAttribLocation(linked, index, name));
  gl.linkProgram(linked);
  if (!gl.getProgramParameter(linked, gl.LINK_STATUS) && !gl.isContextLost())
    throw new Error(gl.getProgramInfoLog(linked));
  const found = { linked };
  const count = gl.getProgramParameter(linked, gl.ACTIVE_UNIFORMS) ?? 0;
  for (let index = 0; index < count; index++) {
    const name = gl.getActiveUniform(linked, index).name.replace("[0]", "");
    found[name] = gl.getUniformLocation(linked, name);
  }
  return found;
};

/** Return the scene on a canvas, null where the browser has no WebGL2. */
const createScene = (canvas, lost) => {
  const gl = canvas.getContext("webgl2", { antialias: false });
  if (!gl) return null;
  // Without a graphics card the processor draws: fewer pixels while the robot moves.
  const renderer = rendererOf(gl).toLowerCase();
  const isSoftware = PAGE.softwareRenderers.some((part) => renderer.includes(part));
  const MATERIALS = Object.keys(PAGE.meshes.materials);
  let solid, flat, meshes, shapes, texture, stretchedFor, textureFor;

  const attribute = (index, data, size, type, normalized = false) => {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(index);
    gl.vertexAttribPointer(index, size, type, normalized, 0, 0);
    return buffer;
  };
  const prepare = () => {
    solid = programOf(gl, SOLID_POINTS, SOLID_COLORS, ["point", "normal", "material"]);
    flat = programOf(gl, FLAT_POINTS, FLAT_COLORS, ["point"]);
    meshes = {};
    shapes = {};
    stretchedFor = textureFor = null;
    for (const [name, body] of Object.entries(BODIES)) {
      const array = gl.createVertexArray();
      gl.bindVertexArray(array);
      const points = attribute(0, new Float32Array(body.points.length), 3, gl.FLOAT);
      attribute(1, body.normals, 3, gl.BYTE, true);
      attribute(2, body.materials, 1, gl.UNSIGNED_BYTE);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, body.faces, gl.STATIC_DRAW);
      meshes[name] = { array, points, count: body.faces.length };
    }
    for (const [name, mode, points] of [
      ["square", gl.TRIANGLE_STRIP, [-1, -1, 0, 1, -1, 0, -1, 1, 0, 1, 1, 0]],
      ["circle", gl.TRIANGLE_STRIP, ringPoints(0.012)],
      ["ring", gl.TRIANGLE_STRIP, ringPoints(0.08)],
      ["arrows", gl.TRIANGLES, arrowPoints()],
    ]) {
      const array = gl.createVertexArray();
      gl.bindVertexArray(array);
      attribute(0, new Float32Array(points), 3, gl.FLOAT);
      shapes[name] = { array, mode, count: points.length / 3 };
    }
    texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    for (const [name, value] of [
      [gl.TEXTURE_MIN_FILTER, gl.LINEAR], [gl.TEXTURE_MAG_FILTER, gl.NEAREST],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
    ])
      gl.texParameteri(gl.TEXTURE_2D, name, value);
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  };
  prepare();
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  canvas.addEventListener("webglcontextrestored", () => {
    prepare();
    lost();
  });

  /** Give every body the shape that it has with a robot's lengths. */
  const stretch = (robot) => {
    const lengths = bodyLengths(robot);
    const key = JSON.stringify(lengths);
    if (key === stretchedFor) return lengths;
    stretchedFor = key;
    for (const [name, body] of Object.entries(BODIES)) {
      gl.bindBuffer(gl.ARRAY_BUFFER, meshes[name].points);
      gl.bufferData(gl.ARRAY_BUFFER, stretched(body, lengths), gl.STATIC_DRAW);
    }
    return lengths;
  };
  const drawFlat = (name, color, matrix, kind = 0) => {
    gl.uniform4fv(flat.color, color);
    gl.uniform1i(flat.kind, kind);
    gl.uniformMatrix4fv(flat.body, false, matrix);
    gl.bindVertexArray(shapes[name].array);
    gl.drawArrays(shapes[name].mode, 0, shapes[name].count);
  };
  const scaled = (size, x, y, z, turn = 0) => {
    const matrix = shifted(x, y, z, turn);
    for (let index = 0; index < 8; index++) matrix[index] *= size;
    return matrix;
  };

  /**
   * Draw a robot at a pose that it can take. `floor` is a picture and half its width, or null;
   * `colors` are those of the page as parts of 1: `m1` to `m4`, `ink`; `circle` and `singular`
   * are radii, `held` says whether the handle is in use, `moving` that more pictures follow.
   */
  const draw = ({ robot, pose, solved, view, floor, circle, singular, dark, colors, held, moving }) => {
    if (gl.isContextLost()) return null;
    const screen = window.devicePixelRatio || 1;
    const ratio = moving && isSoftware ? screen : Math.max(screen, SHARPNESS);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const wanted = [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
    if (canvas.width !== wanted[0] || canvas.height !== wanted[1])
      [canvas.width, canvas.height] = wanted;
    const camera = cameraOf(view, wanted[0] / wanted[1]);
    const lengths = stretch(robot);
    gl.viewport(0, 0, ...wanted);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);

    gl.useProgram(solid.linked);
    gl.disable(gl.BLEND);
    gl.uniformMatrix4fv(solid.camera, false, camera.matrix);
    gl.uniform3fv(solid.eye, camera.eye);
    const table = MATERIALS.map((name) => PAGE.meshes.materials[(dark && `dark ${name}` in
      PAGE.meshes.materials) ? `dark ${name}` : name]);
    const linear = (color) => color.map((part) => part ** 2.2);
    gl.uniform2fv(solid.surfaces, table.flatMap((row) => [row[3], row[4]]));
    const own = MATERIALS.indexOf("accent");
    for (const { body, accent, matrix } of placedBodies(robot, pose, solved)) {
      gl.uniform4fv(solid.colors, table.flatMap((row, index) =>
        [...(accent && index === own ? linear(colors[`m${accent}`]) : row.slice(0, 3)), row[5] ? 1 : 0]));
      gl.uniformMatrix4fv(solid.body, false, matrix);
      gl.bindVertexArray(meshes[body].array);
      gl.drawElements(gl.TRIANGLES, meshes[body].count, gl.UNSIGNED_SHORT, 0);
    }

    gl.useProgram(flat.linked);
    gl.enable(gl.BLEND);
    gl.uniformMatrix4fv(flat.camera, false, camera.matrix);
    gl.depthMask(false);
    const [scale, gap] = [robot.scale, robot.scale * FLOOR_GAP];
    const ground = scale * lengths.ground + gap;
    const [x, y, theta, z] = pose;
    if (floor) {
      if (floor.picture !== textureFor) {
        textureFor = floor.picture;
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, floor.picture);
      }
      drawFlat("square", [1, 1, 1, 1], scaled(floor.radius, 0, 0, ground), 1);
    } else drawFlat("square", [0.1, 0.12, 0.15, 0.4], scaled(0.31 * scale, x, y, ground), 2);
    if (circle > 0) drawFlat("circle", [...colors.good, 1], scaled(circle, 0, 0, ground + gap));
    if (singular > 0) drawFlat("circle", [...colors.bad, 1], scaled(singular, 0, 0, ground + gap));
    drawFlat("ring", [...colors.ink, 1], scaled(0.012 * scale, x, y, ground + 2 * gap));

    // The handle is as large at any distance, and nothing hides it.
    gl.disable(gl.DEPTH_TEST);
    const center = [x, y, z + robot.mechanism.joint_height];
    const size = HANDLE_SIZE * pictured(camera, center)[2] / (camera.pixels * height);
    const color = held ? [0.88, 0.63, 0, 1] : [...colors.ink, 0.6];
    drawFlat("ring", color, scaled(size, ...center, theta));
    drawFlat("arrows", color, scaled(size, ...center));
    gl.enable(gl.DEPTH_TEST);
    gl.depthMask(true);
    return camera;
  };
  return { draw };
};
