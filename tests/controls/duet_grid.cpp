// RepRapFirmware's own Grid.cpp with as much of the firmware around it as it needs: a map is read from a file, and what
// is added to Z at places from standard input is printed. Sizes are those of a Duet 2.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>

#define SUPPORT_OBJECT_MODEL 0
#define SUPPORT_PROBE_POINTS_FILE 0
#define HAS_MASS_STORAGE 1
#define HAS_SBC_INTERFACE 0
#define INHERIT_OBJECT_MODEL
#define DECLARE_OBJECT_MODEL_WITH_ARRAYS
#define pre(condition)
#define ARRAY_SIZE(a) (sizeof(a) / sizeof(a[0]))
#define ARRAY_UPB(a) (ARRAY_SIZE(a) - 1)
constexpr size_t MaxGridProbePoints = 441, MaxAxis0GridPoints = 41, MaxFilenameLength = 120, StringLength500 = 500;

struct StringRef {
    char *at;
    size_t size;
    StringRef(char *to, size_t n) : at(to), size(n) {}
    const char *c_str() const { return at; }
    void copy(const char *text) const { snprintf(at, size, "%s", text); }
    void cat(const char *text) const { catf("%s", text); }
    void cat(char one) const { catf("%c", one); }
    void Clear() const { at[0] = 0; }
    template <typename... A> void printf(const char *how, A... a) const { snprintf(at, size, how, a...); }
    template <typename... A> void catf(const char *how, A... a) const {
        size_t n = strlen(at);
        snprintf(at + n, size - n, how, a...);
    }
};
template <size_t N> struct String {
    char held[N + 1] = {};
    StringRef GetRef() { return StringRef(held, N + 1); }
    void Clear() { held[0] = 0; }
    void copy(const char *text) { GetRef().copy(text); }
    const char *c_str() const { return held; }
};
template <size_t N> struct LargeBitmap {
    bool held[N] = {};
    void ClearAll() { memset(held, 0, sizeof held); }
    void SetBit(size_t n) { held[n] = true; }
    bool IsBitSet(size_t n) const { return held[n]; }
};
struct FileStore {
    FILE *file;
    bool Write(const char *) { return false; }
    int ReadLine(char *to, size_t size) { // a line that does not fit is cut
        if (!fgets(to, (int)size, file)) return -1;
        size_t n = strcspn(to, "\r\n");
        if (!to[n] && !feof(file)) return -1;
        to[n] = 0;
        return (int)n;
    }
};
struct Deviation {
    void Set(double, double, unsigned) {}
    double GetMean() { return 0; }
    double GetDeviationFromMean() { return 0; }
};
struct {
    struct Codes {
        size_t GetAxisNumberForLetter(char letter) { return letter - 'X'; }
        size_t GetVisibleAxes() { return 3; }
    } codes;
    struct Platform { bool GetDateTime(tm &) { return false; } } platform;
    Codes &GetGCodes() { return codes; }
    Platform &GetPlatform() { return platform; }
} reprap;

static float SafeStrtof(const char *from, const char **end) { return strtof(from, (char **)end); }
static uint32_t StrToU32(const char *from, const char **end) { return strtoul(from, (char **)end, 10); }
static bool StringStartsWith(const char *text, const char *head) { return !strncmp(text, head, strlen(head)); }
static float fsquare(float a) { return a * a; }
static double dsquare(double a) { return a * a; }
static float fastSqrtf(float a) { return sqrtf(a); }
template <typename T> static T max(T a, T b) { return a > b ? a : b; }

#include "Grid.cpp"

int main(int, char **words) {
    FileStore map = {fopen(words[1], "r")};
    char why[200] = "";
    HeightMap held;
    if (!map.file || held.LoadFromFile(&map, words[1], StringRef(why, sizeof why))) {
        printf("refused: %s\n", why);
        return 1;
    }
    held.UseHeightMap(true);
    float x, y;
    while (scanf("%f %f", &x, &y) == 2) printf("%.7f\n", (double)held.GetInterpolatedHeightError(x, y));
}
