// A page of one figure.
"use strict";
(() => {
  const figure = kinshipPage.byId("figure");
  kinshipFigures[figure.dataset.figure](figure, kinshipPage.data);
})();
