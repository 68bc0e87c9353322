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

// A round dot with a white rim.
salbench.dot = function () {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const context = canvas.getContext("2d");
  for (const [radius, colour] of [[31, "#ffffff"], [22, "#d55e00"]]) {
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
    const canvas = root.querySelector("canvas");
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: true, preserveDrawingBuffer: true});
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(0xffffff);
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
    this.mapMenu.replaceChildren(...Array.from(this.shape.maps.keys(), (label) => new Option(label, label)));
    this.mapMenu.value = this.shape.maps.has(wanted) ? wanted : this.mapMenu.options[0] ? this.mapMenu.options[0].value : "";
    this.build();
    this.paint();
    this.resize();
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
    const values = this.shape.maps.get(this.mapMenu.value);
    const colours = this.object.geometry.getAttribute("color");
    for (let i = 0; i < this.shape.points; ++i) {
      const value = values ? Math.round(values[i] / this.shape.levels * 255) : 0;
      const shade = this.shape.shade ? 0.45 + 0.55 * this.shape.shade[i] / this.shape.levels : 1;
      for (let c = 0; c < 3; ++c) {
        const start = 6 * value + 2 * c;
        colours.array[3 * i + c] = shade * parseInt(salbench.palette.slice(start, start + 2), 16);
      }
    }
    colours.needsUpdate = true;
    this.status.textContent = this.shape.title + ": " + (this.mapMenu.value || "no map") + ", "
      + this.shape.points + " points";
    this.draw();
  }

  lookFrom(direction) {
    this.camera.position.copy(direction).multiplyScalar(4.2);
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
    this.renderer.render(this.scene, this.camera);
  }
};

salbench.view = async function (root) {
  const entries = JSON.parse(root.dataset.shapes);
  const coupled = root.querySelector("[data-part=coupled]");
  const picks = root.querySelector("[data-part=picks]");
  salbench.picks = picks.checked;
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
