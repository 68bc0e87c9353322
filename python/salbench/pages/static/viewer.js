// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";
// Two views of a mesh or its scans, coupled if wanted. Shapes come as scripts (viewer.py), since pages opened from disk may
// not read files in any other way; each is loaded when it is first shown.

salbench.shapes = new Map();   // name -> promise of {points, faces, shade, maps, ...}
salbench.arrivals = new Map(); // name -> function that takes what its script gives

// A shape may also stand in the page itself: then it is there before anybody asks for it.
salbench.give = function (name, description, data) {
  const arrived = salbench.arrivals.get(name);
  if (arrived) arrived({description, data});
  else salbench.shapes.set(name, salbench.unpack({description, data}));
};

salbench.load = function (entry) {
  if (!salbench.shapes.has(entry.name)) {
    const given = new Promise((resolve, reject) => {
      salbench.arrivals.set(entry.name, resolve);
      const script = document.createElement("script");
      script.src = entry.path;
      script.onerror = () => reject(new Error(entry.path + " is missing"));
      document.head.append(script);
    });
    salbench.shapes.set(entry.name, given.then(salbench.unpack));
  }
  return salbench.shapes.get(entry.name);
};

// The inverse of viewer_parts.py's call(): undoes differences, and spreads positions over the shape's cube.
salbench.unpack = async function ({description, data}) {
  const packed = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = await new Response(stream).arrayBuffer();
  const n = description.points;
  let at = 0;
  const take = (Type, count) => {
    const part = new Type(bytes.slice(at, at + count * Type.BYTES_PER_ELEMENT));
    at += count * Type.BYTES_PER_ELEMENT;
    return part;
  };
  const sum = (values) => { for (let i = 1; i < values.length; ++i) values[i] += values[i - 1]; return values; };
  const position = new Float32Array(3 * n);
  for (let axis = 0; axis < 3; ++axis) {
    const values = sum(take(Uint16Array, n));
    for (let i = 0; i < n; ++i) position[3 * i + axis] = description.corner[axis] + values[i] / description.steps * description.edge;
  }
  const faces = new Uint32Array(sum(take(Int32Array, 3 * description.faces)));
  const shade = description.shaded ? take(Uint8Array, n) : null;
  const maps = new Map(description.maps.map((label) => [label, take(Uint8Array, n)]));
  return {...description, position, faces, shade, maps};
};

// Size of a PointsMaterial whose points are `width` wide: three.js 111 leaves the field of view out.
salbench.spread = (width) => width / Math.tan(Math.PI / 12);

salbench.TRUTH = "Ground truth";
salbench.DIFFERENCE = ", difference to the ground truth";

// Scales: what of a map its colours show. `below`: the share of the points whose value is lower.
salbench.BANDS = [[0, 0], [0.5, 0.2], [0.75, 0.4], [0.9, 0.6], [0.95, 0.8], [0.99, 1]]; // [from this share on, place on the palette]
salbench.scales = {
  value: {ends: ["lowest value", "highest value"], of: (value) => value},
  rank: {ends: ["lowest rank", "highest rank"], of: (value, below, most) => below / most},
  percentile: {ends: ["lower half", "upper half, then top 25, 10, 5 and 1 %"],
    of: (value, below) => salbench.BANDS.filter(([from]) => below >= from).pop()[1]},
};

// A map under a scale, 0 to 1 for each point.
salbench.scaled = function (levels, most, scale) {
  const counts = new Float64Array(256), table = new Float32Array(256);
  for (const level of levels) ++counts[level];
  let last = 255;
  while (last > 0 && !counts[last]) --last;
  const range = Math.max(levels.length - counts[last], 1);
  for (let level = 0, lower = 0; level <= last; lower += counts[level++]) {
    table[level] = scale.of(level / most, lower / levels.length, range / levels.length);
  }
  return Float32Array.from(levels, (level) => table[level]);
};

// What a label of the menu shows: numbers of the points, and the table of palette.js that they are looked up in.
salbench.shown = function (shape, label, scale) {
  const map = (name) => salbench.scaled(shape.maps.get(name), shape.levels, salbench.scales[scale]);
  if (shape.maps.has(label)) return {numbers: map(label), palette: "palette"};
  const model = label.slice(0, -salbench.DIFFERENCE.length), truth = map(salbench.TRUTH);
  const own = map(shape.maps.has(model + ", after matching") ? model + ", after matching" : model + ", before matching");
  return {numbers: own.map((value, i) => (value - truth[i] + 1) / 2), palette: "diverging"};
};

// Labels of the menu by the group that they stand in: maps of models, and their differences to the ground truth.
salbench.labels = function (maps) {
  const groups = new Map([["", []], ["Before matching", []], ["After matching", []], ["Where a model is wrong", []]]);
  for (const label of maps.keys()) {
    const [, model, when] = label.match(/^(.*), (before|after) matching$/) || [];
    groups.get(when ? when[0].toUpperCase() + when.slice(1) + " matching" : "").push(label);
    const wrong = groups.get("Where a model is wrong");
    const difference = model + salbench.DIFFERENCE;
    if (when && maps.has(salbench.TRUTH) && !wrong.includes(difference)) wrong.push(difference);
  }
  return groups;
};

// A table of palette.js, three numbers a colour.
salbench.colours = function (name) {
  return Uint8Array.from(salbench[name].match(/../g), (digits) => parseInt(digits, 16));
};

// The colours of a scale from its lowest on the left, as a background.
salbench.legend = function (palette, scale) {
  const colours = salbench.colours(palette), banded = palette === "palette" && scale === "percentile";
  const places = banded ? salbench.BANDS.map((band) => band[1]) : Array.from({length: 33}, (_, i) => i / 32);
  const stops = places.map((place, i) => {
    const at = 3 * Math.round(255 * place), colour = "rgb(" + colours.slice(at, at + 3).join(",") + ")";
    return banded ? `${colour} ${100 * i / places.length}% ${100 * (i + 1) / places.length}%` : colour;
  });
  return "linear-gradient(to right, " + stops.join(", ") + ")";
};

// A round dot with a white rim.
salbench.dot = function () {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const context = canvas.getContext("2d");
  for (const [radius, colour] of [[31, "#ffffff"], [22, "#" + salbench.pick]]) {
    context.fillStyle = colour;
    context.beginPath();
    context.arc(32, 32, radius, 0, 2 * Math.PI);
    context.fill();
  }
  return new THREE.CanvasTexture(canvas);
};

salbench.View = class {
  constructor(root, entries, onTurn) {
    this.root = root;
    this.entries = entries;
    this.shapeMenu = root.querySelector("[data-part=shape]");
    this.mapMenu = root.querySelector("[data-part=map]");
    this.status = root.querySelector("[data-part=status]");
    this.side = root.querySelector("[data-part=side]");
    const canvas = root.querySelector("canvas");
    this.renderer = new THREE.WebGLRenderer({canvas, alpha: true, antialias: true, preserveDrawingBuffer: true});
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.scene = new THREE.Scene();
    this.upright = new THREE.Group(); // turns the shape's upward axis to y, about which the controls turn
    this.scene.add(this.upright);
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
    this.light = new THREE.DirectionalLight(0xffffff, 0.65);
    this.scene.add(new THREE.AmbientLight(0xffffff, 0.45), this.light);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.enableKeys = false; // the arrow keys turn the shape, below
    this.controls.enablePan = false;
    this.controls.addEventListener("change", () => { this.draw(); onTurn(this); });
    this.shapeMenu.addEventListener("change", () => this.show().then(() => this.home && this.lookFrom(this.home)));
    this.mapMenu.addEventListener("change", () => this.paint());
    canvas.addEventListener("keydown", (event) => {
      const turn = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key];
      if (turn) { event.preventDefault(); this.turn(...turn); }
    });
    for (const button of root.querySelectorAll("button[data-turn]")) {
      button.addEventListener("click", () => this.turn(...button.dataset.turn.split(",").map(Number)));
    }
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }

  async show(map) {
    const entry = this.entries[this.shapeMenu.selectedIndex];
    this.status.textContent = "Loading " + entry.title + " …";
    try {
      this.shape = await salbench.load(entry);
    } catch (error) {
      this.status.textContent = error.message;
      return;
    }
    const wanted = map || this.mapMenu.value;
    this.fillMenu();
    const known = Array.from(this.mapMenu.options, (option) => option.value);
    this.mapMenu.value = known.includes(wanted) ? wanted : known[0] || "";
    this.build();
    this.paint();
    this.resize();
  }

  fillMenu() {
    this.mapMenu.replaceChildren();
    for (const [name, labels] of salbench.labels(this.shape.maps)) {
      const group = name ? document.createElement("optgroup") : this.mapMenu;
      if (name) group.label = name;
      for (const label of labels) group.append(new Option(label, label));
      if (name && labels.length) this.mapMenu.append(group);
    }
  }

  build() {
    if (this.object) { this.upright.remove(this.object, this.dots); this.object.geometry.dispose(); }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(this.shape.position, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(new Uint8Array(3 * this.shape.points), 3, true));
    geometry.computeBoundingSphere();
    const {center, radius} = geometry.boundingSphere;
    if (this.shape.faces.length) {
      geometry.setIndex(new THREE.BufferAttribute(this.shape.faces, 1));
      geometry.computeVertexNormals();
      this.object = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial(
        {vertexColors: THREE.VertexColors, side: THREE.DoubleSide}));
    } else {
      this.object = new THREE.Points(geometry, new THREE.PointsMaterial(
        {vertexColors: THREE.VertexColors, size: salbench.spread(1.4 * this.shape.spacing / radius)}));
    }
    const picked = new THREE.BufferGeometry();
    const at = new Float32Array(3 * this.shape.picks.length);
    this.shape.picks.forEach((pick, i) => at.set(this.shape.position.subarray(3 * pick, 3 * pick + 3), 3 * i));
    picked.setAttribute("position", new THREE.BufferAttribute(at, 3));
    this.dots = new THREE.Points(picked, new THREE.PointsMaterial(
      {map: salbench.dot(), alphaTest: 0.5, size: salbench.spread(0.035)}));
    for (const part of [this.object, this.dots]) { // every shape fills a sphere of radius 1 about the origin
      part.scale.setScalar(1 / radius);
      part.position.copy(center).multiplyScalar(-1 / radius);
    }
    this.upright.rotation.x = this.shape.up === "z" ? -Math.PI / 2 : 0;
    this.upright.add(this.object, this.dots);
    this.home = (this.shape.camera ? new THREE.Vector3(...this.shape.camera).sub(center) : new THREE.Vector3(1, 0.6, 1.2))
      .applyQuaternion(this.upright.quaternion).normalize();
    this.dots.visible = salbench.picks;
  }

  paint() {
    const label = this.mapMenu.value, scale = salbench.scale;
    const {numbers, palette} = label ? salbench.shown(this.shape, label, scale) : {palette: "palette"};
    const table = salbench.colours(palette), colours = this.object.geometry.getAttribute("color");
    for (let i = 0; i < this.shape.points; ++i) {
      const start = 3 * Math.round(255 * (numbers ? numbers[i] : 0));
      const shade = this.shape.shade ? 0.45 + 0.55 * this.shape.shade[i] / this.shape.levels : 1;
      for (let c = 0; c < 3; ++c) colours.array[3 * i + c] = shade * table[start + c];
    }
    colours.needsUpdate = true;
    this.status.textContent = this.shape.title + ": " + (label || "no map") + ", " + this.shape.points + " points";
    this.root.querySelector("[data-part=legend]").style.backgroundImage = salbench.legend(palette, scale);
    const ends = palette === "palette" ? salbench.scales[scale].ends : ["only people look", "only the model looks"];
    for (const [end, text] of ends.entries()) this.root.querySelectorAll("[data-part=end]")[end].textContent = text;
    this.draw();
  }

  // As near as the whole shape can be seen from there.
  lookFrom(direction) {
    this.upright.updateMatrixWorld(true);
    const right = new THREE.Vector3(0, 1, 0).cross(direction).normalize(), up = direction.clone().cross(right);
    const half = Math.tan(this.camera.fov * Math.PI / 360), point = new THREE.Vector3();
    let distance = 1;
    for (let i = 0; i < this.shape.position.length; i += 3) {
      point.fromArray(this.shape.position, i).applyMatrix4(this.object.matrixWorld);
      const most = Math.max(Math.abs(point.dot(right)) / this.camera.aspect, Math.abs(point.dot(up)));
      distance = Math.max(distance, point.dot(direction) + 1.04 * most / half);
    }
    this.camera.position.copy(direction).multiplyScalar(distance);
    this.controls.update();
    this.draw();
  }

  turn(right, down) { // steps of 15 degrees about the upright axis, and up or down
    const place = new THREE.Spherical().setFromVector3(this.camera.position);
    place.theta += right * Math.PI / 12;
    place.phi += down * Math.PI / 12;
    this.camera.position.setFromSpherical(place.makeSafe());
    this.controls.update();
    this.draw();
  }

  resize() {
    const width = this.renderer.domElement.parentElement.clientWidth;
    this.renderer.setSize(width, Math.round(width * 0.85));
    this.camera.aspect = 1 / 0.85;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    this.light.position.copy(this.camera.position);
    if (this.dots) { // nearer to the eye than the surface that they lie on
      const towards = this.camera.position.clone().applyQuaternion(this.upright.quaternion.clone().inverse()).normalize();
      this.dots.position.copy(this.object.position).addScaledVector(towards, 0.025);
    }
    this.side.textContent = this.shape ? ", from " + salbench.side(this.camera.position, this.shape.up) : "";
    this.renderer.render(this.scene, this.camera);
  }
};

// Azimuth and elevation of a camera above y, in whole degrees, as options of pictures take them.
salbench.side = (place, up) => {
  const {theta, phi} = new THREE.Spherical().setFromVector3(place), degrees = 180 / Math.PI;
  const azimuth = Math.round(theta * degrees) + (up === "z" ? 180 : 0);
  return "azimuth " + (azimuth > 180 ? azimuth - 360 : azimuth) + ", elevation " + Math.round(90 - phi * degrees);
};

salbench.view = async function (root) {
  const entries = JSON.parse(root.dataset.shapes);
  const coupled = root.querySelector("[data-part=coupled]");
  const picks = root.querySelector("[data-part=picks]");
  const scale = root.querySelector("[data-part=scale]");
  salbench.picks = picks.checked;
  salbench.scale = scale.value;
  let following = false; // a view that follows the other does not lead it back
  const views = [];
  const follow = (leader) => {
    if (following || !coupled.checked) return;
    following = true;
    for (const view of views) if (view !== leader) { view.camera.position.copy(leader.camera.position); view.controls.update(); view.draw(); }
    following = false;
  };
  for (const part of root.querySelectorAll(".view")) views.push(new salbench.View(part, entries, follow));
  salbench.views = views;
  coupled.addEventListener("change", () => follow(views[0]));
  scale.addEventListener("change", () => {
    salbench.scale = scale.value;
    for (const view of views) if (view.shape) view.paint();
  });
  picks.addEventListener("change", () => {
    salbench.picks = picks.checked;
    for (const view of views) if (view.dots) { view.dots.visible = picks.checked; view.draw(); }
  });
  for (const [index, view] of views.entries()) await view.show(index === 0 ? "Ground truth" : root.dataset.second);
  for (const view of views) if (view.home) view.lookFrom(views[0].home || view.home);
  root.querySelector("[data-part=home]").addEventListener("click", () => {
    for (const view of views) if (view.home) view.lookFrom(coupled.checked && views[0].home || view.home);
  });
  root.dataset.ready = "yes";
};

addEventListener("DOMContentLoaded", () => {
  const root = document.querySelector(".viewer[data-shapes]");
  if (!root) return;
  root.hidden = false;
  salbench.view(root).catch((error) => {
    root.querySelector("[data-part=message]").textContent =
      "The viewer cannot start here (" + error.message + "); the pictures below show the same maps.";
  });
});
