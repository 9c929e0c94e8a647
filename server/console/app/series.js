// Numbers that come once a second, as lines over the last minutes.
"use strict";
const kinshipSeries = (() => {
  const {make} = kinshipPage;
  const kWidth = 600, kHeight = 150, kFoot = 18, kTop = 14;
  const kSeconds = 180;

  function svg(tag, properties, ...children) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(properties)) element.setAttribute(name, value);
    element.append(...children);
    return element;
  }

  /// 1, 2 or 5 times a power of ten, not below a number.
  function roundUp(number) {
    const power = 10 ** Math.floor(Math.log10(number));
    return [1, 2, 5, 10].map((step) => step * power).find((step) => step >= number * 0.999999);
  }

  /// \param series.label  what a reader hears
  /// \param series.lines  each {name, color: of the style}
  /// \param series.text   a number as text
  /// \param series.least  the scale's end, at the least
  /// \return {add(seconds, [value or null, ...])}
  function show(element, {label, lines, text, least}) {
    const points = [];
    const figure = svg("svg", {class: "series", role: "img", "aria-label": label, viewBox: `0 0 ${kWidth} ${kHeight}`, preserveAspectRatio: "none"});
    const keys = make("div", {class: "keys"}, ...lines.map((line) => make("span", {}, make("i", {style: `--hue: var(--${line.color})`}), line.name, " ", make("b", {}))));
    const scale = make("p", {class: "note"});
    element.append(keys, figure, scale);

    function pathOf(index, begin, top) {
      let path = "", pen = "M";
      for (const {seconds, values} of points) {
        if (values[index] === null) { pen = "M"; continue; }
        const x = (seconds - begin) / kSeconds * kWidth;
        const y = kHeight - kFoot - values[index] / top * (kHeight - kFoot - kTop);
        path += `${pen}${x.toFixed(1)} ${y.toFixed(1)}`;
        pen = "L";
      }
      return path;
    }

    function add(seconds, values) {
      points.push({seconds, values});
      while (points[0].seconds < seconds - kSeconds) points.shift();
      const top = roundUp(Math.max(least, ...points.flatMap((point) => point.values.filter((value) => value !== null))));
      figure.replaceChildren(
        ...[0, 0.5, 1].map((part) => {
          const y = kHeight - kFoot - part * (kHeight - kFoot - kTop);
          return svg("line", {class: "rule", x1: 0, x2: kWidth, y1: y, y2: y});
        }),
        ...lines.map((line, i) => {
          const path = svg("path", {d: pathOf(i, seconds - kSeconds, top)});
          path.style.stroke = `var(--${line.color})`;
          return path;
        }));
      lines.forEach((line, i) => { keys.children[i].lastChild.textContent = values[i] === null ? "\u2013" : text(values[i]); });
      scale.textContent = `The last ${kSeconds / 60} minutes; the scale ends at ${text(top)}.`;
      figure.setAttribute("aria-label", label + ": " + lines.map((line, i) => `${line.name} ${values[i] === null ? "unknown" : text(values[i])}`).join(", "));
    }

    return {add};
  }

  return {show};
})();
