// The hands that turn, move and zoom a view.

const TURN = 0.008,
  KEY = 0.12,
  ZOOM = 1.15; // rad for a pixel of a drag, and for a key; factor of a key

/* Pointer, wheel and keys: one finger or button turns, two fingers or the right button move, the wheel zooms. */
export function hands(canvas, { turn, zoom, shift, fit, picked }) {
  const down = new Map();
  const spread = () => {
    const [a, b] = [...down.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  const point = ({ clientX, clientY }) => {
    const box = canvas.getBoundingClientRect();
    picked(clientX - box.left, clientY - box.top);
  };
  canvas.addEventListener("pointerdown", (event) => {
    down.set(event.pointerId, { x: event.clientX, y: event.clientY });
    canvas.setPointerCapture(event.pointerId);
    if (event.pointerType === "touch") point(event);
  });
  for (const name of ["pointerup", "pointercancel"])
    canvas.addEventListener(name, (event) => down.delete(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    const before = down.get(event.pointerId),
      here = { x: event.clientX, y: event.clientY };
    if (!before) return point(event);
    const [x, y] = [here.x - before.x, here.y - before.y],
      wide = down.size === 2 ? spread() : 0;
    down.set(event.pointerId, here);
    if (down.size === 2) {
      zoom(spread() / Math.max(wide, 1));
      shift(x / 2, y / 2);
    } else if (event.shiftKey || event.buttons & 6) shift(x, y);
    else turn(-TURN * x, TURN * y);
  });
  canvas.addEventListener("pointerleave", (event) => event.pointerType !== "touch" && picked(null)); // a finger may leave
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)));
    },
    { passive: false },
  );
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  const keys = {
    ArrowLeft: () => turn(-KEY, 0),
    ArrowRight: () => turn(KEY, 0),
    ArrowUp: () => turn(0, KEY),
    ArrowDown: () => turn(0, -KEY),
    "+": () => zoom(ZOOM),
    "=": () => zoom(ZOOM),
    "-": () => zoom(1 / ZOOM),
    0: fit,
  };
  canvas.addEventListener("keydown", (event) => {
    if (!keys[event.key] || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    keys[event.key]();
  });
}
