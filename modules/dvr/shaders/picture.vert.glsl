// Polygons in the picture: pixels, row 0 on top. `rank` is a depth between 0 (near) and 1.
layout(location = 0) in vec2 picture_px;
uniform vec2 size_px;
uniform float rank;
void main() { gl_Position = vec4(picture_px / size_px * 2.0 - 1.0, 2.0 * rank - 1.0, 1.0); }
