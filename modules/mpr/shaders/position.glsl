// Where a pixel's centre lies in the volume: voxel = origin + x * right + y * down + n * deeper, with x, y, n whole
// numbers. A float holds no more than 24 bits, so a voxel coordinate of 500 would have lost its fraction beyond 3e-5;
// interpolation across a bone edge shows that. Hence each vector comes as a head of few bits, whose product with a
// whole number is exact, and a small tail; whole parts and fractions are summed apart. The fraction keeps about 22
// bits.
uniform vec3 originWhole;
uniform vec3 originPart;
uniform vec3 rightHead;
uniform vec3 rightTail;
uniform vec3 downHead;
uniform vec3 downTail;
#ifdef DEEPER
uniform vec3 deeperHead;
uniform vec3 deeperTail;
#endif

void position(float n, out vec3 whole, out vec3 part) {
  vec2 pixel = floor(gl_FragCoord.xy);
  vec3 a = pixel.x * rightHead;
  vec3 b = pixel.y * downHead;
  vec3 wa = floor(a);
  vec3 wb = floor(b);
  vec3 f = originPart + (a - wa) + (b - wb) + (pixel.x * rightTail + pixel.y * downTail);
  whole = originWhole + wa + wb;
#ifdef DEEPER
  vec3 c = n * deeperHead;
  vec3 wc = floor(c);
  f += (c - wc) + n * deeperTail;
  whole += wc;
#endif
  vec3 wf = floor(f);
  whole += wf;
  part = f - wf;
}

// The border is half a voxel wide; rounding must not lose a plane that lies on it.
const float kBorder = 0.500001;

// Is whole + part within [-0.5, count - 0.5]?
bool inside(float whole, float part, float count) {
  return whole + part >= -kBorder && (whole - (count - 1.0)) + part <= kBorder;
}
