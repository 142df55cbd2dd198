/* Embree behind a pipe: reads a scene, then answers questions about rays, so that benches/kernel.rs can measure the same
 * rays in turns with its own kernel. Built by that benchmark with `cc`, if Embree 3 (Debian: libembree-dev) is there.
 *
 *   server SCENE            prints "ready SECONDS BYTES" once the hierarchies are built
 *   rays FILE               n rays of 8 floats: origin, tnear, direction, tfar     -> "rays N"
 *   closest|any|packets T   sends all rays with T threads                          -> "done CPU_SECONDS HITS"
 *   dump FILE               the distance of each ray's nearest hit, one float each -> "done 0 N"
 *
 * CPU_SECONDS is the processor time of all threads together: other work on the machine does not count.
 * The scene file is written by benches/support/embree.rs; its layout is described there.
 */
#define _GNU_SOURCE
#include <embree3/rtcore.h>
#include <immintrin.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { CHUNK = 256 };
enum Question { CLOSEST, ANY, PACKETS, DUMP };

typedef struct { float org[3], tnear, dir[3], tfar; } Ray;

static RTCDevice device;
static RTCScene root;
static Ray *rays;
static float *distances;
static size_t n_rays;
static atomic_size_t next_ray, n_hits;
static enum Question question;
static atomic_llong bytes_used;

static bool count_bytes(void *user, ssize_t bytes, bool post) {
    (void)user; (void)post;
    atomic_fetch_add(&bytes_used, bytes);
    return true;
}

static double seconds(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void read_all(void *to, size_t size, FILE *file) {
    if (size && fread(to, size, 1, file) != 1) { fprintf(stderr, "the file is too short\n"); exit(1); }
}

static uint32_t read_count(FILE *file) {
    uint32_t count;
    read_all(&count, sizeof count, file);
    return count;
}

static void finish(RTCScene scene, RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
}

static void add_triangles(RTCScene scene, FILE *file) {
    uint32_t n_vertices = read_count(file), n_triangles = read_count(file);
    if (!n_triangles) return;
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    read_all(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, n_vertices), 12 * (size_t)n_vertices, file);
    read_all(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, n_triangles), 12 * (size_t)n_triangles, file);
    finish(scene, mesh);
}

static void add_quads(RTCScene scene, FILE *file) {
    uint32_t n = read_count(file);
    if (!n) return;
    RTCGeometry quads = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
    read_all(rtcSetNewGeometryBuffer(quads, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 4 * (size_t)n), 48 * (size_t)n, file);
    uint32_t *index = rtcSetNewGeometryBuffer(quads, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 16, n);
    for (uint32_t i = 0; i < 4 * n; i++) index[i] = i;
    finish(scene, quads);
}

static void add_cones(RTCScene scene, FILE *file) {
    uint32_t n = read_count(file);
    if (!n) return;
    RTCGeometry cones = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE);
    read_all(rtcSetNewGeometryBuffer(cones, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, 2 * (size_t)n), 32 * (size_t)n, file);
    uint32_t *index = rtcSetNewGeometryBuffer(cones, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, 4, n);
    for (uint32_t i = 0; i < n; i++) index[i] = 2 * i;
    finish(scene, cones);
}

static void add_instances(RTCScene scene, RTCScene *groups, FILE *file) {
    uint32_t n = read_count(file);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t group = read_count(file);
        float matrix[12];
        read_all(matrix, sizeof matrix, file);
        RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(instance, groups[group]);
        rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix);
        finish(scene, instance);
    }
}

static void build(const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) { perror(path); exit(1); }
    uint32_t n_groups = read_count(file);
    RTCScene *groups = calloc(n_groups, sizeof *groups);
    for (uint32_t i = 0; i < n_groups; i++) {
        groups[i] = rtcNewScene(device);
        add_triangles(groups[i], file);
        add_quads(groups[i], file);
        add_cones(groups[i], file);
        add_instances(groups[i], groups, file);
        rtcCommitScene(groups[i]);
    }
    root = groups[n_groups - 1];
    fclose(file);
}

static void load_rays(const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) { perror(path); exit(1); }
    fseek(file, 0, SEEK_END);
    n_rays = (size_t)ftell(file) / sizeof(Ray);
    rewind(file);
    free(rays);
    free(distances);
    rays = malloc(n_rays * sizeof(Ray) + 1);
    distances = malloc(n_rays * sizeof(float) + 1);
    read_all(rays, n_rays * sizeof(Ray), file);
    fclose(file);
}

static size_t closest(size_t from, size_t to) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    size_t hits = 0;
    for (size_t i = from; i < to; i++) {
        const Ray *r = rays + i;
        struct RTCRayHit q;
        q.ray.org_x = r->org[0]; q.ray.org_y = r->org[1]; q.ray.org_z = r->org[2]; q.ray.tnear = r->tnear;
        q.ray.dir_x = r->dir[0]; q.ray.dir_y = r->dir[1]; q.ray.dir_z = r->dir[2]; q.ray.tfar = r->tfar;
        q.ray.time = 0; q.ray.mask = (unsigned)-1; q.ray.id = 0; q.ray.flags = 0;
        q.hit.geomID = RTC_INVALID_GEOMETRY_ID; q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(root, &context, &q);
        int hit = q.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        hits += hit;
        if (question == DUMP) distances[i] = hit ? q.ray.tfar : INFINITY;
    }
    return hits;
}

static size_t any(size_t from, size_t to) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    size_t hits = 0;
    for (size_t i = from; i < to; i++) {
        const Ray *r = rays + i;
        struct RTCRay q;
        q.org_x = r->org[0]; q.org_y = r->org[1]; q.org_z = r->org[2]; q.tnear = r->tnear;
        q.dir_x = r->dir[0]; q.dir_y = r->dir[1]; q.dir_z = r->dir[2]; q.tfar = r->tfar;
        q.time = 0; q.mask = (unsigned)-1; q.id = 0; q.flags = 0;
        rtcOccluded1(root, &context, &q);
        hits += q.tfar < 0;
    }
    return hits;
}

static size_t packets(size_t from, size_t to) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    size_t hits = 0;
    for (size_t i = from; i < to; i += 8) {
        struct RTCRayHit8 q;
        int valid[8] __attribute__((aligned(32)));
        for (size_t k = 0; k < 8; k++) {
            valid[k] = i + k < to ? -1 : 0;
            const Ray *r = rays + (i + k < to ? i + k : i);
            q.ray.org_x[k] = r->org[0]; q.ray.org_y[k] = r->org[1]; q.ray.org_z[k] = r->org[2]; q.ray.tnear[k] = r->tnear;
            q.ray.dir_x[k] = r->dir[0]; q.ray.dir_y[k] = r->dir[1]; q.ray.dir_z[k] = r->dir[2]; q.ray.tfar[k] = r->tfar;
            q.ray.time[k] = 0; q.ray.mask[k] = (unsigned)-1; q.ray.id[k] = 0; q.ray.flags[k] = 0;
            q.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID; q.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect8(valid, root, &context, &q);
        for (size_t k = 0; k < 8; k++) hits += valid[k] && q.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
    }
    return hits;
}

static void *work(void *cpu_seconds) {
    /* What Embree's manual asks of programs that want its full speed. */
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _mm_setcsr(_mm_getcsr() | 0x0040);
    double start = seconds(CLOCK_THREAD_CPUTIME_ID);
    size_t hits = 0;
    for (;;) {
        size_t from = atomic_fetch_add(&next_ray, CHUNK);
        if (from >= n_rays) break;
        size_t to = from + CHUNK < n_rays ? from + CHUNK : n_rays;
        hits += question == ANY ? any(from, to) : question == PACKETS ? packets(from, to) : closest(from, to);
    }
    atomic_fetch_add(&n_hits, hits);
    *(double *)cpu_seconds = seconds(CLOCK_THREAD_CPUTIME_ID) - start;
    return NULL;
}

static void ask(enum Question what, int n_threads) {
    pthread_t threads[64];
    double cpu[64], sum = 0;
    if (n_threads < 1) n_threads = 1;
    if (n_threads > 64) n_threads = 64;
    question = what;
    atomic_store(&next_ray, 0);
    atomic_store(&n_hits, 0);
    for (int i = 0; i < n_threads; i++) pthread_create(threads + i, NULL, work, cpu + i);
    for (int i = 0; i < n_threads; i++) { pthread_join(threads[i], NULL); sum += cpu[i]; }
    printf("done %.9f %zu\n", sum, (size_t)atomic_load(&n_hits));
    fflush(stdout);
}

int main(int argc, char **argv) {
    if (argc != 2) return 1;
    device = rtcNewDevice(NULL);
    rtcSetDeviceMemoryMonitorFunction(device, count_bytes, NULL);
    double start = seconds(CLOCK_MONOTONIC);
    build(argv[1]);
    printf("ready %.6f %lld\n", seconds(CLOCK_MONOTONIC) - start, (long long)atomic_load(&bytes_used));
    fflush(stdout);
    char line[4096], path[4096];
    int n_threads;
    while (fgets(line, sizeof line, stdin)) {
        if (sscanf(line, "rays %4095[^\n]", path) == 1) {
            load_rays(path);
            printf("rays %zu\n", n_rays);
            fflush(stdout);
        } else if (sscanf(line, "closest %d", &n_threads) == 1) ask(CLOSEST, n_threads);
        else if (sscanf(line, "any %d", &n_threads) == 1) ask(ANY, n_threads);
        else if (sscanf(line, "packets %d", &n_threads) == 1) ask(PACKETS, n_threads);
        else if (sscanf(line, "dump %4095[^\n]", path) == 1) {
            FILE *file = fopen(path, "wb");
            if (!file) { perror(path); return 1; }
            question = DUMP;
            closest(0, n_rays);
            if (fwrite(distances, sizeof *distances, n_rays, file) != n_rays) return 1;
            fclose(file);
            printf("done 0 %zu\n", n_rays);
            fflush(stdout);
        } else return 1;
    }
    return 0;
}
