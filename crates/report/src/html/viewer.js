"use strict";
// Turns every element of class "spheres" into a picture that follows the mouse. Each sphere is a
// square facing the camera; the fragment shader cuts the ball out of it and sets the depth, so
// spheres that overlap meet where they should. Without WebGL 2 the picture inside stays.
// data-kinds: of each kind its spheres (x, y, z, radius); data-bodies: of each body its kind, its
// place and its turn (w, x, y, z); all as 32-bit floats in base 64. data-colours: of each kind.
(() => {
  const VERTEX = `#version 300 es
    layout(location = 0) in vec2 corner;
    layout(location = 1) in vec4 sphere;
    layout(location = 2) in float kind;
    uniform vec3 colours[8];
    uniform mat3 turn;
    uniform float zoom;
    out vec2 place;
    flat out float radius;
    flat out float middle;
    flat out vec3 colour;
    void main() {
      vec3 centre = turn * sphere.xyz;
      place = corner;
      radius = sphere.w;
      middle = centre.z;
      colour = colours[int(kind + 0.5) % 8];
      gl_Position = vec4(zoom * (centre.xy + corner * sphere.w), 0.0, 1.0);
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec2 place;
    flat in float radius;
    flat in float middle;
    flat in vec3 colour;
    out vec4 result;
    void main() {
      float outside = dot(place, place);
      if (outside > 1.0) discard;
      vec3 normal = vec3(place, sqrt(1.0 - outside));
      float near = middle + radius * normal.z;
      gl_FragDepth = 0.5 - 0.49 * near;
      float key = max(dot(normal, normalize(vec3(-0.5, 0.65, 0.75))), 0.0);
      float fill = max(dot(normal, normalize(vec3(0.8, -0.1, 0.45))), 0.0);
      result = vec4(colour * (0.28 + 0.62 * key + 0.26 * fill), 1.0);
    }`;

  // The view of the picture inside: from the front, the right and above.
  const HOME = { heading: 0.602, tilt: 0.434, zoom: 0.94 };

  const floatsOf = (text) => {
    const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    return Float32Array.from({ length: bytes.length / 4 }, (_, i) => view.getFloat32(4 * i, true));
  };

  // The spheres of all bodies where they are, and the kind of each.
  const placed = (kinds, bodies) => {
    const counts = [];
    for (let b = 0; b < bodies.length; b += 8) counts.push(kinds[bodies[b]].length / 4);
    const total = counts.reduce((sum, n) => sum + n, 0);
    const [spheres, kindOf] = [new Float32Array(4 * total), new Float32Array(total)];
    let next = 0;
    counts.forEach((count, number) => {
      const [kind, x, y, z, w, i, j, k] = bodies.subarray(8 * number, 8 * number + 8);
      const own = kinds[kind];
      for (let from = 0; from < 4 * count; from += 4) {
        const a = own[from];
        const b = own[from + 1];
        const c = own[from + 2];
        // v + w t + q x t with t = 2 q x v
        const tx = 2 * (j * c - k * b);
        const ty = 2 * (k * a - i * c);
        const tz = 2 * (i * b - j * a);
        spheres[4 * next] = x + a + w * tx + j * tz - k * ty;
        spheres[4 * next + 1] = y + b + w * ty + k * tx - i * tz;
        spheres[4 * next + 2] = z + c + w * tz + i * ty - j * tx;
        spheres[4 * next + 3] = own[from + 3];
        kindOf[next] = kind;
        next += 1;
      }
    });
    return [spheres, kindOf];
  };

  const programOf = (gl) => {
    const program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    return gl.getProgramParameter(program, gl.LINK_STATUS) ? program : null;
  };

  // Rotation about the horizontal axis of the screen after one about the object's upright z.
  const rotation = (heading, tilt) => {
    const [c, s, u, v] = [Math.cos(heading), Math.sin(heading), Math.cos(tilt), Math.sin(tilt)];
    // Rows: right, up, toward the camera; WebGL takes columns.
    return [c, -v * s, u * s, s, v * c, -u * c, 0, u, v];
  };

  const start = (box) => {
    const canvas = document.createElement("canvas");
    const gl = canvas.getContext("webgl2", { antialias: true });
    const program = gl && programOf(gl);
    if (!program) return;
    const kinds = box.dataset.kinds.split(" ").map(floatsOf);
    const [spheres, kindOf] = placed(kinds, floatsOf(box.dataset.bodies));
    const colours = box.dataset.colours.split(/[ ,]/).map((part) => part / 255);
    const buffer = (data, slot, size, divisor) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(slot);
      gl.vertexAttribPointer(slot, size, gl.FLOAT, false, 0, 0);
      gl.vertexAttribDivisor(slot, divisor);
    };
    buffer(new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]), 0, 2, 0);
    buffer(spheres, 1, 4, 1);
    buffer(kindOf, 2, 1, 1);
    const uniform = (name) => gl.getUniformLocation(program, name);
    const view = { ...HOME };

    const draw = () => {
      const side = Math.max(1, Math.round(canvas.clientWidth * Math.max(2, devicePixelRatio)));
      if (canvas.width !== side) canvas.width = canvas.height = side;
      gl.viewport(0, 0, side, side);
      gl.enable(gl.DEPTH_TEST);
      gl.clearColor(0.98, 0.98, 0.973, 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.useProgram(program);
      gl.uniformMatrix3fv(uniform("turn"), false, rotation(view.heading, view.tilt));
      gl.uniform1f(uniform("zoom"), view.zoom);
      gl.uniform3fv(uniform("colours"), colours.slice(0, 24));
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, spheres.length / 4);
    };
    let waiting = false;
    const change = (heading, tilt, zoom) => {
      view.heading += heading;
      view.tilt = Math.max(-1.57, Math.min(1.57, view.tilt + tilt));
      view.zoom = Math.max(0.5, Math.min(8, view.zoom * zoom));
      if (!waiting) {
        waiting = true;
        requestAnimationFrame(() => { waiting = false; draw(); });
      }
    };

    const hint = document.createElement("p");
    hint.className = "hint";
    hint.textContent = "Drag to turn, Ctrl + wheel or + and − to zoom, double click to go back.";
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", box.querySelector("img").alt);
    box.append(canvas, hint);
    box.classList.add("live");

    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (canvas.hasPointerCapture(event.pointerId)) {
        change(-0.01 * event.movementX, 0.01 * event.movementY, 1);
      }
    });
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      change(0, 0, Math.exp(-0.002 * event.deltaY));
    }, { passive: false });
    canvas.addEventListener("dblclick", () => {
      Object.assign(view, HOME);
      change(0, 0, 1);
    });
    canvas.addEventListener("keydown", (event) => {
      const steps = {
        ArrowLeft: [0.1, 0, 1], ArrowRight: [-0.1, 0, 1], ArrowUp: [0, -0.1, 1],
        ArrowDown: [0, 0.1, 1], "+": [0, 0, 1.1], "-": [0, 0, 1 / 1.1],
      };
      const step = steps[event.key];
      if (!step) return;
      event.preventDefault();
      change(...step);
    });
    new ResizeObserver(() => change(0, 0, 1)).observe(canvas);
    draw();
  };

  for (const box of document.querySelectorAll(".spheres")) start(box);
})();
