// Of the closed body (lens and box): its front and back, and the transitions, where region 0 (behind and beside the lens)
// begins and region 2 (before it) ends. Alpha 0: there is no such region on the line.
uniform sampler2D boxFront;
uniform sampler2D boxBack;
layout(location = 0) out vec4 transition0;
layout(location = 1) out vec4 transition1;
layout(location = 2) out vec4 lensFront;
layout(location = 3) out vec4 lensBack;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 front = texelFetch(boxFront, pixel, 0);
  vec4 back = texelFetch(boxBack, pixel, 0);
  transition0 = front;  // beside the lens region 0 begins with the box
  transition1 = lensFront = lensBack = vec4(0.0);
  if (front.a == 0.0) return;
  Line line = lineOfPixel();
  vec2 box = vec2(depthOf(line, front.xyz), depthOf(line, back.xyz));
  vec2 lens = within(line, vec2(-1.0e30, 1.0e30));
  vec2 both = vec2(max(lens.x, box.x), min(lens.y, box.y));
  if (!(both.x < both.y)) return;
  lensFront = vec4(pointAt(line, both.x), 1.0);
  lensBack = vec4(pointAt(line, both.y), 1.0);
  transition0 = lens.y < box.y ? lensBack : vec4(0.0);
  transition1 = lens.x > box.x ? lensFront : vec4(0.0);
}
