// The editor without a controller, for tests. Without a controller, Load only shows the length of the text.

import { createEditor } from './editor.js';

const TEXT = `name = "alone"

[machine]
crank_radius_mm = 10
lambda = 0.25            # crank radius over rod length
load_kg = 8

[limits]
speed_hz = 60
acceleration_hz_per_s = 60
jerk_hz_per_s2 = 600
band = [{ from_hz = 25, to_hz = 29 }]

[axes]
count = 4
drive = "stepper"
steps_per_turn = 3200

[[program]]
amax_g = 15
ramp_s = 2
hold_s = 3

[[program]]
amax_g = 70
ramp_s = 4
hold_s = 5
`;

window.editor = createEditor(document.getElementById('editor'), {
  text: TEXT,
  onLoad: (text) => `${text.length} characters would be loaded.`,
});
