/* The scene of a report, to be turned: meshes, lines and bars by WebGL, without any library.

The data are those that `packing.py` writes. Places are mm in the base frame; z is up, or y where
the machine lies in a plane. */
"use strict";
(() => {
const FOV = Math.PI / 6, FILLED = 0.84, STEPS = 65535;
const VERTEX = `
attribute vec3 at; attribute vec3 normal;
uniform mat4 seen; uniform mat4 placed; uniform mat4 shown;
varying vec3 facing;
void main() {
  facing = mat3(placed) * normal;
  gl_Position = shown * seen * placed * vec4(at, 1.0);
}`;
const FRAGMENT = `
precision mediump float;
uniform vec4 color; uniform float lit; uniform vec3 below;
varying vec3 facing;
void main() {
  if (lit < 0.5) { gl_FragColor = color; return; }
  vec3 n = normalize(gl_FrontFacing ? facing : -facing);
  vec3 sun = normalize(vec3(0.5, -0.7, 1.3)), fill = normalize(vec3(-0.9, 0.4, 0.5));
  vec3 sky = mix(below, vec3(1.0), 0.5 + 0.5 * n.z);
  vec3 light = 0.26 + 0.36 * sky + 0.52 * max(dot(n, sun), 0.0) + 0.16 * max(dot(n, fill), 0.0);
  gl_FragColor = vec4(min(color.rgb * light, 1.0), color.a);
}`;

const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
const floats = (text) => new Float32Array(bytes(text));
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const add = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => { const n = Math.hypot(...a) || 1; return [a[0] / n, a[1] / n, a[2] / n]; };
const rgb = (code) => [1, 3, 5].map((n) => parseInt(code.slice(n, n + 2), 16) / 255);
const EYE = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/* A mesh with a normal at each vertex, the mean of the faces there. */
const unpack = (mesh) => {
  const steps = new Uint16Array(bytes(mesh.at)), at = new Float32Array(steps.length);
  for (let n = 0; n < steps.length; n++) {
    at[n] = mesh.low[n % 3] + mesh.span * steps[n] / STEPS;
  }
  const faces = mesh.wide ? new Uint32Array(bytes(mesh.faces)) : new Uint16Array(bytes(mesh.faces));
  const normal = new Float32Array(at.length);
  const point = (k) => [at[3 * k], at[3 * k + 1], at[3 * k + 2]];
  for (let n = 0; n < faces.length; n += 3) {
    const a = point(faces[n]);
    const turned = cross(sub(point(faces[n + 1]), a), sub(point(faces[n + 2]), a));
    for (let k = 0; k < 3; k++) {
      for (let m = 0; m < 3; m++) normal[3 * faces[n + k] + m] += turned[m];
    }
  }
  return { at, normal, faces };
};

/* The turn and the stretch that take a cylinder on z, 1 long and 1 thick, between two places. */
const between = (a, b, radius, out, n) => {
  const along = sub(b, a), long = Math.hypot(...along), z = unit(along);
  const r = long < 1e-6 ? 0 : radius;
  const x = unit(cross(Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], z)), y = cross(z, x);
  out.set([r * x[0], r * x[1], r * x[2], 0, r * y[0], r * y[1], r * y[2], 0,
    ...along, 0, ...a, 1], 16 * n);
};

class Viewer {
  constructor(place, data) {
    this.place = place; this.data = data;
    this.canvas = place.querySelector("canvas");
    this.names = place.querySelector(".names");
    this.gl = this.canvas.getContext("webgl", { antialias: true, alpha: false });
    if (!this.gl || !this.gl.getExtension("OES_element_index_uint")) throw new Error("no WebGL");
    this.off = new Set();
    place.querySelectorAll("[data-group]").forEach((box) => {
      const keep = () => {
        if (box.checked) this.off.delete(box.dataset.group); else this.off.add(box.dataset.group);
        this.late();
      };
      box.addEventListener("change", keep);
      keep();
    });
    this.dark = window.matchMedia("(prefers-color-scheme: dark)");
    this.dark.addEventListener("change", () => this.late());
    this.load();
    this.listen();
    this.look(data.first);
    new ResizeObserver(() => this.late()).observe(this.canvas);
  }

  load() {
    const gl = this.gl, data = this.data, made = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    }
    gl.bindAttribLocation(made, 0, "at");
    gl.bindAttribLocation(made, 1, "normal");
    gl.linkProgram(made);
    gl.useProgram(made);
    this.given = {};
    for (const name of ["seen", "placed", "shown", "color", "lit", "below"]) {
      this.given[name] = gl.getUniformLocation(made, name);
    }
    const buffer = (kind, values) => {
      const b = gl.createBuffer();
      gl.bindBuffer(kind, b);
      gl.bufferData(kind, values, gl.STATIC_DRAW);
      return b;
    };
    const mesh = (packed) => {
      const { at, normal, faces } = unpack(packed);
      return {
        ...packed, count: faces.length, points: at,
        type: packed.wide ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT,
        atB: buffer(gl.ARRAY_BUFFER, at), normalB: buffer(gl.ARRAY_BUFFER, normal),
        facesB: buffer(gl.ELEMENT_ARRAY_BUFFER, faces),
      };
    };
    this.meshes = data.meshes.map(mesh);
    this.cylinder = mesh(data.cylinder);
    this.lines = data.lines.map((lines) => {
      const at = floats(lines.at);
      return { ...lines, count: at.length / 3, points: at, atB: buffer(gl.ARRAY_BUFFER, at) };
    });
    this.ends = floats(data.bars.ends);
    this.platforms = floats(data.platform);
    this.turns = new Float32Array(16 * data.bars.count);
    this.now = 0;
    this.at(0);
  }

  /* Put the machine where it is at a time, between two known places by a straight line. */
  at(time) {
    const { times, bars } = this.data;
    this.now = time;
    let n = times.findIndex((t) => t >= time);
    if (n < 0) n = times.length - 1;
    const before = Math.max(n - 1, 0);
    const share = times[n] > times[before] ? (time - times[before]) / (times[n] - times[before]) : 0;
    const mixed = (all, size, k) => {
      const a = all[size * before + k], b = all[size * n + k];
      return a + share * (b - a);
    };
    const wide = 6 * bars.count;
    for (let k = 0; k < bars.count; k++) {
      const end = [0, 1, 2, 3, 4, 5].map((m) => mixed(this.ends, wide, 6 * k + m));
      between(end.slice(0, 3), end.slice(3), bars.radius[k], this.turns, k);
    }
    const row = Array.from({ length: 16 }, (_, k) => mixed(this.platforms, 16, k));
    const turned = [[row[0], row[4], row[8]], [row[1], row[5], row[9]]].map(unit);
    const third = unit(cross(turned[0], turned[1])), second = cross(third, turned[0]);
    this.platform = [...turned[0], 0, ...second, 0, ...third, 0, row[3], row[7], row[11], 1];
    this.late();
  }

  /* All that is to be seen: places of what is on display. */
  *seen() {
    if (!this.off.has("machine")) {
      for (let k = 0; k < this.data.bars.count; k++) {
        const t = this.turns.subarray(16 * k, 16 * k + 16);
        if (!t[0] && !t[1] && !t[2]) continue;
        yield [t[12], t[13], t[14]];
        yield [t[12] + t[8], t[13] + t[9], t[14] + t[10]];
      }
    }
    for (const mesh of this.meshes) {
      if (this.off.has(mesh.group) || mesh.frame !== "base") continue;
      for (let n = 0; n < mesh.points.length; n += 3) {
        yield [mesh.points[n], mesh.points[n + 1], mesh.points[n + 2]];
      }
    }
  }

  axes() {
    const back = this.toward, up = this.data.planar ? [0, 1, 0] : [0, 0, 1];
    let right = cross(up, back);
    if (Math.hypot(...right) < 1e-6) right = [1, 0, 0];
    right = unit(right);
    return [right, cross(back, right), back];
  }

  /* Look from a direction, with everything in the picture. */
  look(toward) {
    this.toward = unit(toward);
    this.fit();
  }

  /* Look as somebody did who kept it: at a place, from so far, with what was shown then. */
  stand(toward, target, away, shown) {
    if (shown) {
      this.place.querySelectorAll("[data-group]").forEach((box) => {
        box.checked = shown.includes(box.dataset.group);
        box.dispatchEvent(new Event("change"));
      });
    }
    Object.assign(this, { toward: unit(toward), target, distance: away });
    this.late();
  }

  fit() {
    const [right, up, back] = this.axes();
    const tall = FILLED * Math.tan(FOV / 2);
    const shape = this.canvas.clientWidth / Math.max(this.canvas.clientHeight, 1);
    const wide = tall * Math.max(shape, 0.2);
    const most = [0, 0, 0, 0].map(() => -Infinity);
    let near = -Infinity, far = Infinity;
    for (const p of this.seen()) {
      const x = dot(p, right), y = dot(p, up), z = dot(p, back);
      most[0] = Math.max(most[0], wide * z + x);
      most[1] = Math.max(most[1], wide * z - x);
      most[2] = Math.max(most[2], tall * z + y);
      most[3] = Math.max(most[3], tall * z - y);
      near = Math.max(near, z);
      far = Math.min(far, z);
    }
    if (!Number.isFinite(near)) return;
    const x = 0.5 * (most[0] - most[1]), y = 0.5 * (most[2] - most[3]), z = 0.5 * (near + far);
    const away = Math.max(0.5 * (most[0] + most[1]) / wide, 0.5 * (most[2] + most[3]) / tall, near);
    this.target = add(add(add([0, 0, 0], right, x), up, y), back, z);
    this.distance = Math.max(away - z, 1e-3 * this.data.size);
    this.late();
  }

  turn(dx, dy) {
    const up = this.data.planar ? 1 : 2, other = this.data.planar ? [2, 0] : [0, 1];
    const t = this.toward;
    const azimuth = Math.atan2(t[other[1]], t[other[0]]) - dx;
    const height = Math.min(Math.max(Math.asin(t[up]) + dy, -1.55), 1.55);
    const made = [0, 0, 0];
    made[up] = Math.sin(height);
    made[other[0]] = Math.cos(height) * Math.cos(azimuth);
    made[other[1]] = Math.cos(height) * Math.sin(azimuth);
    this.toward = made;
    this.late();
  }

  shift(dx, dy) {
    const [right, up] = this.axes();
    const size = 2 * this.distance * Math.tan(FOV / 2) / Math.max(this.canvas.clientHeight, 1);
    this.target = add(add(this.target, right, -dx * size), up, dy * size);
    this.late();
  }

  zoom(by) {
    const size = this.data.size;
    this.distance = Math.min(Math.max(this.distance * by, 0.05 * size), 60 * size);
    this.late();
  }

  listen() {
    const canvas = this.canvas, held = new Map();
    let apart = 0;
    canvas.addEventListener("pointerdown", (e) => {
      canvas.setPointerCapture(e.pointerId);
      held.set(e.pointerId, e);
      apart = 0;
    });
    canvas.addEventListener("pointermove", (e) => {
      const before = held.get(e.pointerId);
      if (!before) return;
      const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
      held.set(e.pointerId, e);
      if (held.size > 1) {
        const [a, b] = [...held.values()];
        const wide = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
        if (apart) this.zoom(apart / Math.max(wide, 1));
        apart = wide;
        this.shift(dx / 2, dy / 2);
      } else if (e.buttons & 2 || e.shiftKey) this.shift(dx, dy);
      else this.turn(dx * 0.008, dy * 0.008);
    });
    for (const type of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(type, (e) => held.delete(e.pointerId));
    }
    canvas.addEventListener("contextmenu", (e) => e.preventDefault());
    canvas.addEventListener("wheel", (e) => {
      if (!e.ctrlKey && document.activeElement !== canvas) return;
      e.preventDefault();
      this.zoom(Math.exp(Math.min(Math.max(e.deltaY * 0.0015, -0.5), 0.5)));
    }, { passive: false });
    const keys = {
      ArrowLeft: () => this.turn(-0.1, 0), ArrowRight: () => this.turn(0.1, 0),
      ArrowUp: () => this.turn(0, 0.1), ArrowDown: () => this.turn(0, -0.1),
      "+": () => this.zoom(0.9), "=": () => this.zoom(0.9), "-": () => this.zoom(1.1),
      f: () => this.fit(),
    };
    canvas.addEventListener("keydown", (e) => {
      if (!keys[e.key] || e.ctrlKey || e.metaKey || e.altKey) return;
      e.preventDefault();
      keys[e.key]();
    });
    this.place.querySelectorAll("[data-look]").forEach((button) => {
      const [, ...from] = this.data.looks[button.dataset.look] || [];
      button.addEventListener("click", () => {
        if (from.length > 1) this.stand(...from);
        else if (from.length) this.look(from[0]);
        else this.fit();
      });
    });
    const play = this.place.querySelector("[data-play]");
    const time = this.place.querySelector("[data-time]");
    if (!play || !time) return;
    const told = this.place.querySelector("[data-told]"), end = this.data.times.at(-1);
    const show = () => { time.value = this.now; told.textContent = this.now.toFixed(2) + " s"; };
    let from = 0;
    const step = (now) => {
      if (!this.playing) return;
      this.at(((now - from) / 1000) % end);
      show();
      requestAnimationFrame(step);
    };
    play.addEventListener("click", () => {
      this.playing = !this.playing;
      play.textContent = this.playing ? "Pause" : "Play";
      from = performance.now() - 1000 * (this.now >= end ? 0 : this.now);
      if (this.playing) requestAnimationFrame(step);
    });
    time.addEventListener("input", () => {
      this.playing = false;
      play.textContent = "Play";
      this.at(Number(time.value));
      show();
    });
    show();
  }

  /* Draw as soon as the browser draws, once. */
  late() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false; this.draw(); });
  }

  draw() {
    const gl = this.gl, canvas = this.canvas, ratio = window.devicePixelRatio || 1;
    const wide = Math.round(canvas.clientWidth * ratio), high = Math.round(canvas.clientHeight * ratio);
    if (!wide || !high) return;
    if (canvas.width !== wide || canvas.height !== high) { canvas.width = wide; canvas.height = high; }
    const dark = this.dark.matches ? 1 : 0;
    const [right, up, back] = this.axes(), eye = add(this.target, back, this.distance);
    const seen = [0, 1, 2].flatMap((n) => [right[n], up[n], back[n], 0]);
    seen.push(-dot(right, eye), -dot(up, eye), -dot(back, eye), 1);
    const near = Math.max(this.distance - 12 * this.data.size, 0.02 * this.distance);
    const far = this.distance + 40 * this.data.size, f = 1 / Math.tan(FOV / 2);
    const shown = [f * high / wide, 0, 0, 0, 0, f, 0, 0,
      0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0];
    gl.viewport(0, 0, wide, high);
    gl.clearColor(...rgb(this.data.back[dark]), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.uniformMatrix4fv(this.given.seen, false, seen);
    gl.uniformMatrix4fv(this.given.shown, false, shown);
    gl.uniform3fv(this.given.below, dark ? [0.35, 0.38, 0.43] : [0.75, 0.77, 0.81]);
    const on = (group) => !this.off.has(group);
    this.drawLines(dark, (lines) => on(lines.group) && lines.group === "ground", EYE);
    for (const mesh of this.meshes) {
      if (on(mesh.group) && mesh.opacity >= 1) this.drawMesh(mesh, dark);
    }
    if (on("machine")) this.drawBars(dark);
    const still = !this.now; /* marks are of the posture at the beginning */
    this.drawLines(dark, ({ group }) => on(group) && group !== "ground" && (still || group !== "marks"), EYE);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    for (const side of ["back", "front"]) {
      for (const mesh of this.meshes) {
        if (on(mesh.group) && mesh.opacity < 1 && mesh.side === side) this.drawMesh(mesh, dark);
      }
    }
    gl.depthMask(true);
    gl.disable(gl.BLEND);
    this.drawNames(seen, shown, on);
  }

  drawMesh(mesh, dark) {
    const gl = this.gl;
    if (mesh.side === "both") gl.disable(gl.CULL_FACE);
    else { gl.enable(gl.CULL_FACE); gl.cullFace(mesh.side === "back" ? gl.FRONT : gl.BACK); }
    this.bind(mesh);
    gl.uniform4f(this.given.color, ...rgb(mesh.color[dark]), mesh.opacity);
    gl.uniform1f(this.given.lit, 1);
    gl.uniformMatrix4fv(this.given.placed, false, mesh.frame === "platform" ? this.platform : EYE);
    gl.drawElements(gl.TRIANGLES, mesh.count, mesh.type, 0);
    gl.disable(gl.CULL_FACE);
  }

  bind(mesh) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.atB);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.normalB);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.facesB);
  }

  drawBars(dark) {
    const gl = this.gl, { bars } = this.data;
    this.bind(this.cylinder);
    gl.uniform1f(this.given.lit, 1);
    for (let k = 0; k < bars.count; k++) {
      const turn = this.turns.subarray(16 * k, 16 * k + 16);
      if (!turn[0] && !turn[1] && !turn[2]) continue;
      gl.uniform4f(this.given.color, ...rgb(bars.color[k][dark]), 1);
      gl.uniformMatrix4fv(this.given.placed, false, turn);
      gl.drawElements(gl.TRIANGLES, this.cylinder.count, this.cylinder.type, 0);
    }
  }

  drawLines(dark, wanted, placed) {
    const gl = this.gl;
    gl.uniform1f(this.given.lit, 0);
    gl.uniformMatrix4fv(this.given.placed, false, placed);
    gl.disableVertexAttribArray(1);
    for (const lines of this.lines.filter(wanted)) {
      gl.bindBuffer(gl.ARRAY_BUFFER, lines.atB);
      gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
      gl.uniform4f(this.given.color, ...rgb(lines.color[dark]), 1);
      gl.drawArrays(gl.LINES, 0, lines.count);
    }
  }

  /* Names beside their points; they belong to the posture at the beginning. */
  drawNames(seen, shown, on) {
    const wide = this.canvas.clientWidth, high = this.canvas.clientHeight;
    this.names.hidden = this.now > 0;
    if (this.names.hidden) return;
    if (!this.names.childElementCount) {
      for (const [text] of this.data.names) {
        const made = document.createElement("span");
        made.textContent = text;
        this.names.append(made);
      }
    }
    const turned = (m, p) => [0, 1, 2, 3].map(
      (r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r] * p[3]);
    this.data.names.forEach(([, at, group], n) => {
      this.names.children[n].hidden = !on(group);
      const p = turned(shown, turned(seen, [...at, 1]));
      const x = (0.5 + 0.5 * p[0] / p[3]) * wide, y = (0.5 - 0.5 * p[1] / p[3]) * high;
      this.names.children[n].style.transform = `translate(${x + 4}px, ${y - 16}px)`;
    });
  }
}

document.querySelectorAll(".scene").forEach((place) => {
  const data = JSON.parse(place.querySelector("script[type='application/json']").textContent);
  try {
    place.classList.add("live"); // it is measured from the beginning
    new Viewer(place, data);
  } catch (error) {
    place.classList.remove("live");
    place.querySelector(".why").textContent =
      "This browser cannot show the scene (" + error.message + "); below is its picture.";
  }
});
})();
