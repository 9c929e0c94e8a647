// Plays a figure: a button, a slider, a speed.
"use strict";
const kinshipPlayer = (() => {
  const {make, isStill} = kinshipPage;

  /// A button, a slider over 0 ... last and a choice of speeds; `show(place)` draws a place and returns what is said of it.
  /// \param seconds  that playing all of it takes
  /// \return {element, put(place), pause()}
  function player(label, last, seconds, show) {
    const slider = make("input", {type: "range", min: 0, max: last, step: "any", value: last, "aria-label": label});
    const output = make("output", {});
    const speed = make("select", {"aria-label": "Speed"}, ...[0.25, 0.5, 1, 2].map((times) =>
      make("option", {value: times, selected: times === 1}, `${times}\u2009\u00d7`)));
    const button = make("button", {type: "button"}, "\u25b6 Play");
    let frame = null, before = 0;
    const put = (place) => {
      slider.value = place;
      const text = show(Number(slider.value));
      output.textContent = text;
      slider.setAttribute("aria-valuetext", text);
    };
    const pause = () => {
      cancelAnimationFrame(frame);
      frame = null;
      button.textContent = "\u25b6 Play";
    };
    const step = (now) => {
      if (!slider.isConnected) return;
      const rest = isStill() ? 0.5 : 0; // who wants no motion gets a picture every half second
      if (now - before < 1000 * rest) {
        frame = requestAnimationFrame(step);
        return;
      }
      put(Math.min(last, Number(slider.value) + last * Number(speed.value) * (rest || (now - before) / 1000) / seconds));
      before = now;
      if (Number(slider.value) >= last) pause();
      else frame = requestAnimationFrame(step);
    };
    button.addEventListener("click", () => {
      if (frame !== null) return pause();
      if (Number(slider.value) >= last) put(0);
      before = performance.now();
      button.textContent = "\u275a\u275a Pause";
      frame = requestAnimationFrame(step);
    });
    slider.addEventListener("input", () => {
      pause();
      put(Number(slider.value));
    });
    return {element: make("div", {class: "player"}, button, slider, output, speed), put, pause};
  }

  return {player};
})();
