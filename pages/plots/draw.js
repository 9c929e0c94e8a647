// A page of one figure.
"use strict";
const shown = (() => {
  const figure = kinshipPage.byId("figure");
  return kinshipFigures[figure.dataset.figure](figure, kinshipPage.data);
})();
