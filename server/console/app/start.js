// After every page is registered.
"use strict";
kinshipConsole.start();
