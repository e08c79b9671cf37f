const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

// Table: a click sorts by the column, best first; a second click turns the order round.
for (const heading of $$("#figures thead th")) {
  $("button", heading).addEventListener("click", () => {
    const column = heading.cellIndex;
    const best = "more" in heading.dataset ? "descending" : "ascending";
    const other = best === "ascending" ? "descending" : "ascending";
    const order = heading.getAttribute("aria-sort") === best ? other : best;
    const key = row => row.cells[column].dataset.value;
    const compare = (a, b) => column ? key(a) - key(b) : key(a).localeCompare(key(b));
    const rows = $$("#figures tbody tr");
    rows.sort((a, b) => {
      const missing = (key(a) === undefined) - (key(b) === undefined); // no figure: always last
      return missing || (order === "ascending" ? compare(a, b) : compare(b, a));
    });
    $$("#figures thead th").forEach(th => th.removeAttribute("aria-sort"));
    heading.setAttribute("aria-sort", order);
    $("#figures tbody").append(...rows);
  });
}

// Comparison. The state is kept in the address, so that a link shows what its sender saw.
const stage = $("#stage"), canvas = $("canvas", stage), context = canvas.getContext("2d");
const names = $$("#left option").map(option => option.textContent);
const [width, height] = ["width", "height"].map(side => +$("#t0-picture").getAttribute(side));
const state = {
  left: 0, right: +$("#right").value, view: "picture", wipe: 0.5, zoom: 1, x: width / 2, y: height / 2, scheme: "",
};
let blinked = false, blinking = 0;

// The truth has no error: its visibility stands in.
const image = (index, view) => $(`#t${index}-${view}`) ?? $(`#t${index}-visibility`);

function geometry() {
  const scale = canvas.width / width * state.zoom;
  const half = [canvas.width / 2 / scale, canvas.height / 2 / scale];
  state.x = clamp(state.x, half[0], width - half[0]);
  state.y = clamp(state.y, half[1], height - half[1]);
  return { scale, left: (half[0] - state.x) * scale, top: (half[1] - state.y) * scale };
}

function drawSide(index, from, to) {
  const { scale, left, top } = geometry();
  context.save();
  context.beginPath();
  context.rect(from, 0, to - from, canvas.height);
  context.clip();
  context.imageSmoothingEnabled = scale < 1.5;
  context.imageSmoothingQuality = "high";
  context.drawImage(image(index, state.view), left, top, width * scale, height * scale);
  context.restore();
}

function draw() {
  const ratio = devicePixelRatio || 1;
  const size = [Math.round(stage.clientWidth * ratio), Math.round(stage.clientHeight * ratio)];
  if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
  const wipe = blinking ? (blinked ? 0 : 1) : state.wipe;
  const line = Math.round(wipe * canvas.width);
  drawSide(state.left, 0, line);
  drawSide(state.right, line, canvas.width);
  if (!blinking) drawHandle(line, ratio);
  $("#left-name").textContent = names[state.left];
  $("#right-name").textContent = names[state.right];
  $("#left-name").hidden = wipe < 0.02;
  $("#right-name").hidden = wipe > 0.98;
}

function drawHandle(x, ratio) {
  context.fillStyle = "rgb(0 0 0 / .35)";
  context.fillRect(x - 2 * ratio, 0, 4 * ratio, canvas.height);
  context.fillStyle = "#fff";
  context.fillRect(x - ratio, 0, 2 * ratio, canvas.height);
  const y = canvas.height / 2;
  context.beginPath();
  context.arc(x, y, 15 * ratio, 0, 7);
  context.fill();
  context.strokeStyle = "rgb(0 0 0 / .35)";
  context.lineWidth = ratio;
  context.stroke();
  context.fillStyle = "#1a1c20";
  for (const side of [-1, 1]) {
    context.beginPath();
    context.moveTo(x + side * 9 * ratio, y);
    context.lineTo(x + side * 4 * ratio, y - 5 * ratio);
    context.lineTo(x + side * 4 * ratio, y + 5 * ratio);
    context.fill();
  }
}

function update() {
  $("#left").value = state.left;
  $("#right").value = state.right;
  $$("[data-view]").forEach(b => b.setAttribute("aria-pressed", b.dataset.view === state.view));
  $$("[data-zoom]").forEach(b => b.setAttribute("aria-pressed", +b.dataset.zoom === state.zoom));
  $("#blink").setAttribute("aria-pressed", !!blinking);
  $("#legend").hidden = state.view !== "error";
  stage.setAttribute("aria-valuenow", Math.round(state.wipe * 100));
  if (state.scheme) document.documentElement.dataset.scheme = state.scheme;
  const shown = [image(state.left, state.view), image(state.right, state.view)];
  Promise.all(shown.map(img => img.decode())).then(draw, draw);
}

let remembering = 0;
function set(changes) {
  Object.assign(state, changes);
  update();
  clearTimeout(remembering);
  remembering = setTimeout(() => history.replaceState(null, "", "#" + new URLSearchParams({
    left: names[state.left], right: names[state.right], view: state.view, wipe: state.wipe.toFixed(3),
    zoom: +state.zoom.toFixed(2), x: Math.round(state.x), y: Math.round(state.y),
  })), 300);
}

function recall() {
  const given = new URLSearchParams(location.hash.slice(1));
  const index = (key) => Math.max(names.indexOf(given.get(key)), 0);
  const number = (key, low, high) => clamp(Number(given.get(key)) || 0, low, high);
  const changes = {};
  for (const key of ["left", "right"]) if (given.has(key)) changes[key] = index(key);
  if (["picture", "visibility", "error"].includes(given.get("view"))) changes.view = given.get("view");
  if (given.has("wipe")) changes.wipe = number("wipe", 0, 1);
  if (given.has("zoom")) changes.zoom = number("zoom", 1, 64);
  if (given.has("x")) changes.x = number("x", 0, width);
  if (given.has("y")) changes.y = number("y", 0, height);
  if (["light", "dark"].includes(given.get("scheme"))) changes.scheme = given.get("scheme");
  Object.assign(state, changes);
  update();
}

// The pixel under the pointer, and the values there (8 bits, as in the pictures).
const values = new Map();
function visibility(index, x, y) {
  if (!values.has(index)) {
    const copy = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    copy.drawImage(image(index, "visibility"), 0, 0);
    values.set(index, copy.getImageData(0, 0, width, height).data);
  }
  return values.get(index)[4 * (y * width + x)] / 255;
}

function under(event) {
  const box = stage.getBoundingClientRect();
  const { scale, left, top } = geometry();
  const at = (offset, size, origin) => (offset / size - origin) / scale;
  return {
    wipe: clamp((event.clientX - box.left) / box.width, 0, 1),
    x: at((event.clientX - box.left) * canvas.width, box.width, left),
    y: at((event.clientY - box.top) * canvas.height, box.height, top),
  };
}

function probe(place) {
  const x = clamp(Math.floor(place.x), 0, width - 1), y = clamp(Math.floor(place.y), 0, height - 1);
  const truth = visibility(0, x, y);
  const parts = [["pixel", `${x}, ${y}`], ["truth", truth.toFixed(3)]];
  for (const index of new Set([state.left, state.right])) {
    if (!index) continue;
    const value = visibility(index, x, y), error = value - truth;
    parts.push([names[index], `${value.toFixed(3)} (${error < 0 ? "−" : "+"}${Math.abs(error).toFixed(3)})`]);
  }
  $("#probe").replaceChildren(...parts.flatMap(([name, value]) => {
    const number = document.createElement("b");
    number.textContent = value;
    return [name + " ", number];
  }));
}

function zoomAt(place, factor) {
  const zoom = clamp(state.zoom * factor, 1, 64), keep = state.zoom / zoom;
  set({ zoom, x: place.x + (state.x - place.x) * keep, y: place.y + (state.y - place.y) * keep });
}

let drag = null;
stage.addEventListener("pointerdown", event => {
  const place = under(event);
  const near = Math.abs(place.wipe - state.wipe) * stage.clientWidth < 28;
  drag = { moves: state.zoom > 1 && !near, from: place };
  stage.setPointerCapture(event.pointerId);
  stage.focus({ preventScroll: true });
  if (!drag.moves) set({ wipe: place.wipe });
});
stage.addEventListener("pointermove", event => {
  const place = under(event);
  probe(place);
  if (!drag) return;
  if (drag.moves) set({ x: state.x + drag.from.x - place.x, y: state.y + drag.from.y - place.y });
  else set({ wipe: place.wipe });
});
for (const end of ["pointerup", "pointercancel"]) stage.addEventListener(end, () => { drag = null; });
stage.addEventListener("dblclick", event => zoomAt(under(event), event.shiftKey ? 0.5 : 2));
stage.addEventListener("wheel", event => {
  if (!event.ctrlKey && !event.metaKey) return; // the page scrolls
  event.preventDefault();
  zoomAt(under(event), 2 ** (-event.deltaY / 120));
}, { passive: false });
stage.addEventListener("keydown", event => {
  const step = { ArrowLeft: -0.02, ArrowRight: 0.02, Home: -1, End: 1 }[event.key];
  if (step === undefined) return;
  event.preventDefault();
  set({ wipe: clamp(state.wipe + step, 0, 1) });
});

$("#left").addEventListener("change", event => set({ left: +event.target.value }));
$("#right").addEventListener("change", event => set({ right: +event.target.value }));
$("#swap").addEventListener("click", () => set({ left: state.right, right: state.left }));
$$("[data-view]").forEach(b => b.addEventListener("click", () => set({ view: b.dataset.view })));
$$("[data-zoom]").forEach(b => b.addEventListener("click", () => set({ zoom: +b.dataset.zoom })));
$("#blink").addEventListener("click", () => {
  clearInterval(blinking);
  blinking = blinking ? 0 : setInterval(() => { blinked = !blinked; draw(); }, 600);
  update();
});
$$("[data-open]").forEach(img => img.addEventListener("click", () => {
  const right = +img.dataset.open;
  set(right ? { left: 0, right, view: img.dataset.kind } : { view: img.dataset.kind });
  $("#compare").scrollIntoView();
}));
new ResizeObserver(draw).observe(stage);
addEventListener("hashchange", recall);
recall();
