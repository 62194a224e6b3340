component axiscal_balls "spheres on the table of an XYZAC machine, touched by a probe";
pin in float x; pin in float y; pin in float z; pin in float a; pin in float c;
pin in float tool "length, mm";
pin in float ay; pin in float az; pin in float cx; pin in float cy "where the axis lines really are, mm";
pin in float bx#[8] = 1e6; pin in float by#[8] = 1e6; pin in float bz#[8] = 1e6 "spheres on the workpiece, mm";
pin in float radius = 15.5;
pin in bit stuck; pin in bit deaf; pin in bit sticky "once touched, it stays so";
pin out bit touched;
option singleton yes;
function _ fp;
license "MIT";
;;
#include <rtapi_math.h>
FUNCTION(_) {
    double p[3] = { x, y - ay, z - tool - az }, q[3], s, k, far;
    int i, hit = 0;
    s = sin(a * M_PI / 180.0); k = cos(a * M_PI / 180.0);
    q[0] = p[0] - cx; q[1] = k * p[1] - s * p[2] + ay - cy; q[2] = s * p[1] + k * p[2] + az;
    s = sin(c * M_PI / 180.0); k = cos(c * M_PI / 180.0);
    p[0] = k * q[0] - s * q[1] + cx; p[1] = s * q[0] + k * q[1] + cy; p[2] = q[2];
    for (i = 0; i < 8; i++) {
        far = sqrt((p[0] - bx(i)) * (p[0] - bx(i)) + (p[1] - by(i)) * (p[1] - by(i)) + (p[2] - bz(i)) * (p[2] - bz(i)));
        if (far <= radius) hit = 1;
    }
    touched = stuck || (hit && !deaf) || (sticky && touched);
}
