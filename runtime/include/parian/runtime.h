/* runtime.h - relighting translucent bodies from a .parian asset, with OpenGL 3.3 core or OpenGL ES 3.0,
 * or in plain C.
 *
 *   parian_scene    an asset in memory; plain data, may serve many renderers and threads
 *   parian_renderer one scene in one GL context (or none: the C evaluation), with lights and settings
 *
 * Only what changed is recomputed: lights or instances -> E, B and picture; camera or settings -> picture alone;
 * exposure -> tone curve alone; what is set to what it was: nothing.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_RUNTIME_H
#define PARIAN_RUNTIME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/light.h"
#include "parian/result.h"

#ifdef __cplusplus
extern "C" {
#endif
#ifdef __GNUC__
#pragma GCC visibility push(default) /* what a shared library exports */
#endif

/* ---- scene ------------------------------------------------------------------------------------- */
typedef struct parian_scene parian_scene;

/* Read and validate an asset. Errors: PARIAN_E_IO, PARIAN_E_FORMAT, PARIAN_E_UNSUPPORTED, PARIAN_E_NOMEM.
 * env is copied; its functions must outlive the scene. */
parian_result parian_scene_open(const parian_env *env, const char *path, parian_scene **scene);
void parian_scene_close(parian_scene *scene);

typedef struct parian_scene_info {
    uint32_t body_count, surrounding_count;
    uint64_t texel_count;  /* owned texels of all bodies */
    uint64_t vertex_count; /* transfer vertices of all bodies */
    float lower[3], upper[3];   /* bounds of everything, metres */
    float body_lower[3], body_upper[3]; /* bounds of the bodies */
    const char *lights_json; /* default lights in the lights-file form, or NULL; lives with the scene */
} parian_scene_info;
parian_scene_info parian_scene_get_info(const parian_scene *scene);

/* One body, index below body_count. */
typedef struct parian_scene_body {
    const char *name, *medium_name;    /* live with the scene; may be empty */
    double sigma_s_prime[3], sigma_a[3], eta; /* m^-1, m^-1, 1 */
    uint32_t atlas_size, chart_count;  /* side of the atlas in texels */
    uint32_t texel_count, vertex_count, triangle_count;
    uint64_t factor_count;             /* throughput factors of the global part */
    bool has_local, has_global;

    /* What a host needs to draw the body itself; all live with the scene. */
    const float (*vertex_position)[3];  /* [vertex_count] metres */
    const uint32_t (*triangle)[3];      /* [triangle_count] counterclockwise from outside */
    const float (*corner_normal)[3][3]; /* [triangle_count][corner] unit */
    const float (*corner_uv)[3][2];     /* [triangle_count][corner] place in the atlas in texels: divide by atlas_size
                                         * for [0, 1]; row 0 is the first of every texture that is handed out */
    const uint32_t *triangle_chart;     /* [triangle_count] */
    const uint32_t *texel_index;        /* [texel_count] row * atlas_size + column of each owned texel */
    const float (*texel_albedo)[3];     /* [texel_count] surface texture T_p, linear; NULL: none */
    const float (*texel_normal_map)[3]; /* [texel_count] unit normals in the space of the vertices; NULL: none */
} parian_scene_body;
/* Zeroed when there is no such body. */
parian_scene_body parian_scene_get_body(const parian_scene *scene, uint32_t index);

/* ---- renderer ---------------------------------------------------------------------------------- */
/* What a renderer does to its GL context: every call puts back what it found, and works whatever it finds:
 * bindings of framebuffers, renderbuffer, program, vertex array, array and pixel buffers, of 2-D and array
 * textures and samplers of units 0 to 15, the active unit; viewport, depth range, function and mask, colour masks
 * and blending of draw buffers 0 to 7; pixel storage; culling, scissor, stencil and depth test, discard, polygon
 * offset, dither, sample coverage and mask, and in OpenGL sRGB, depth clamp, logic op, polygon mode and smoothing,
 * primitive restart, clip distances and clamping of reads. Nothing else is changed but viewports and scissor tests
 * beyond the first of a viewport array, which become like the first. The application must not have transform
 * feedback or conditional rendering active in a call, and a query that is active counts what we draw. A GL error
 * that was pending is dropped with a warning; a current program that was deleted is replaced by none. Objects are
 * created and deleted by calls that create, upload, set, resize or destroy.
 *
 * Any number of scenes and renderers may live in a process, in a context, and in several contexts at once; the
 * context of a renderer is current in every call on it, and calls on one renderer do not overlap. There are no
 * globals. */
typedef struct parian_renderer parian_renderer;

typedef enum parian_backend { PARIAN_BACKEND_GL = 0, PARIAN_BACKEND_CPU = 1 } parian_backend;

typedef struct parian_renderer_desc {
    parian_backend backend;
    /* GL: function loading of the current context, which must be OpenGL 3.3 core or OpenGL ES 3.0 or later
     * and current in every call on this renderer. */
    void *(*get_proc_address)(const char *name);
    uint32_t shadow_size;     /* side of a shadow map (of shading), texels; 0 takes 2048 */
    uint32_t environment_lights; /* directions that stand for an environment, at most 256; 0 takes 64 */
    uint64_t memory_budget;   /* bytes of GL memory (see parian_memory below); 0 is no limit */
    bool deferred_upload;     /* upload nothing yet: parian_renderer_upload does, a slice at a time */
} parian_renderer_desc;

/* Errors: PARIAN_E_ARGUMENT, PARIAN_E_UNSUPPORTED (GL version or extension, named in the log),
 * PARIAN_E_NOMEM, PARIAN_E_DEVICE. The scene must outlive the renderer. */
parian_result parian_renderer_create(const parian_env *env, const parian_scene *scene,
                                     const parian_renderer_desc *desc, parian_renderer **renderer);
void parian_renderer_destroy(parian_renderer *renderer);

/* "Mesa llvmpipe ..., OpenGL ES 3.0", or "C evaluation". */
const char *parian_renderer_name(const parian_renderer *renderer);

/* Replace the lights (copied, images included). Types that this renderer cannot do are
 * PARIAN_E_UNSUPPORTED, lights with absurd numbers PARIAN_E_ARGUMENT; the old lights then stay. */
parian_result parian_renderer_set_lights(parian_renderer *renderer, const parian_light *lights, size_t count);

/* A copy of all bodies of the scene, somewhere else. The transform is column-major, as OpenGL takes it, and a
 * rotation times one scale plus a translation; all zeros is the identity. A scaled body is one of a scaled medium
 * (twice as large: mean free paths twice as long, sigma_a and sigma_s' half), so that B = T E holds as it was baked;
 * lights and surroundings stay where they are and keep their units. */
typedef struct parian_instance {
    float transform[16];
} parian_instance;

enum { PARIAN_INSTANCE_MAX = 4096 };

/* Replace the instances (copied); count 0, as after creation: one where the file has it. Every instance has its own
 * E and B and casts shadows on all others; factors, kernels, atlas tables and meshes are shared. Equal instances
 * change nothing; others relight all at the next relight.
 * Errors: PARIAN_E_ARGUMENT (a transform that is not finite, mirrors, shears, scales unevenly by more than 1e-3, or
 * scales outside 1e-6 to 1e6: its index and what is wrong), PARIAN_E_LIMIT, PARIAN_E_NOMEM; the old ones then stay.
 * Threads: the context's thread. */
parian_result parian_renderer_set_instances(parian_renderer *renderer, const parian_instance *instances,
                                            size_t count);

typedef enum parian_view_mode {
    PARIAN_VIEW_COMBINED = 0, /* translucent, with surface reflection */
    PARIAN_VIEW_LOCAL = 1,    /* scattered light of the local part alone */
    PARIAN_VIEW_GLOBAL = 2,   /* of the global part alone */
    PARIAN_VIEW_IRRADIANCE = 3, /* E on the surface, divided by pi */
    PARIAN_VIEW_OPAQUE = 4,   /* the same total albedo as a Lambertian surface, for comparison */
    PARIAN_VIEW_NORMALS = 5,
    PARIAN_VIEW_CHARTS = 6,
    PARIAN_VIEW_RADIOSITY = 7, /* B on the surface, divided by pi, before the surface texture */
    PARIAN_VIEW_VALUES = 8     /* what parian_renderer_set_values gave */
} parian_view_mode;

typedef struct parian_settings { /* zero is default */
    parian_view_mode view;
    bool no_specular;      /* leave the surface reflection out */
    bool no_albedo;        /* ignore the surface texture T_p */
    bool no_normal_map;
    float roughness;       /* of the specular lobe (GGX alpha = roughness^2); 0 takes 0.35 */
    float background[3];   /* radiance behind everything */
} parian_settings;
parian_result parian_renderer_set_settings(parian_renderer *renderer, const parian_settings *settings);

/* Values that PARIAN_VIEW_VALUES paints on the bodies (of every instance), as linear colours without exposure and
 * tone curve: [texel_count of the scene][3], bodies one after the other as in parian_texel_arrays; copied. Drawing
 * that view without values is PARIAN_E_ARGUMENT. Errors: PARIAN_E_NOMEM, PARIAN_E_DEVICE. */
parian_result parian_renderer_set_values(parian_renderer *renderer, const float (*value)[3]);

/* ---- medium edits ----------------------------------------------------------------------------------
 * A body can be given another medium, size or colour than it was baked of. Surface, atlas and the pairs of
 * vertices that exchange light stay those of the asset; everything else is computed anew, in seconds on
 * threads through the env. What could not follow is reported, with the error it costs. */
typedef struct parian_medium_edit { /* zero is default: as baked */
    float tint[3];       /* B times this when it is shown, apart from transfer, 0 to 10; all zero takes 1,1,1 */
    bool change_medium;  /* take these coefficients: */
    double sigma_s_prime[3], sigma_a[3]; /* m^-1 */
    double eta;          /* 1 to 4; 0: as baked */
    double size_factor;  /* the body, and everything around it, is that many times as large as it was baked and
                          * is still shown at its old size, 0.001 to 1000; 0 takes 1 */
} parian_medium_edit;

typedef enum parian_edit_part { /* bits */
    PARIAN_EDIT_TINT = 1,
    PARIAN_EDIT_OPTICS = 2,       /* Fresnel at entry and exit, albedo of the opaque view */
    PARIAN_EDIT_FACTORS = 4,      /* throughput factors at the pairs that the asset holds */
    PARIAN_EDIT_WEIGHTS = 8,      /* blending weights */
    PARIAN_EDIT_KERNELS = 16,     /* local kernels */
    PARIAN_EDIT_REACH = 32,       /* light between pairs that the asset does not hold */
    PARIAN_EDIT_LOCAL_PART = 64,  /* the body was baked without one, and now needs it */
    PARIAN_EDIT_GLOBAL_PART = 128, /* the same */
    PARIAN_EDIT_RESOLUTION = 256  /* vertices and texels are too coarse for so dense a medium */
} parian_edit_part;

typedef struct parian_medium_report {
    uint32_t exact;       /* parian_edit_part: as a bake of this medium would have them */
    uint32_t approximate; /* followed, at the price of the errors below */
    uint32_t missing;     /* could not follow: the picture is wrong by more than 5 % in places */
    double beyond_mean, beyond_max; /* share of light that belongs between pairs the asset does not hold, and went to
                                     * others instead: mean and largest over receivers, worst channel */
    /* Relative L2 error of B against the direct integral of R_d, measured at 256 receivers, worst channel: under
     * light from afar without shadows, and under a hard-edged checkerboard. 0 where the medium is as baked. */
    double error_smooth, error_hard;
    double energy;        /* B over what it should be, both summed, under the first of them; worst channel */
    double seconds;       /* that the edit took */
    char text[512];       /* one line for people */
} parian_medium_report;

/* Edit one body of all instances; edit NULL: as baked. Replaces an earlier edit. The next draw or relight runs the
 * passes that are affected: a tint shading alone, a medium everything after E, an index of refraction E as well.
 * report may be NULL; what is missing is also logged as a warning. Errors: PARIAN_E_ARGUMENT (no such body, a medium
 * that cannot be; the line names the number), PARIAN_E_UNSUPPORTED, PARIAN_E_NOMEM, PARIAN_E_INTERRUPTED: the
 * medium stays what it was; PARIAN_E_DEVICE: the body must be edited again before it is right. Threads: the
 * context's thread. */
parian_result parian_renderer_set_medium(parian_renderer *renderer, uint32_t body, const parian_medium_edit *edit,
                                         parian_medium_report *report);

/* Bring E and B up to date with lights and instances; does nothing when nothing changed. */
parian_result parian_renderer_relight(parian_renderer *renderer);

/* Take everything for changed, so that the next relight and draw run every pass: for measuring. */
void parian_renderer_invalidate(parian_renderer *renderer);

/* Sets of samples. Relighting asks at one set: the centroid of each texel, fixed points of rectangles, mean
 * directions of an environment's parts. Each call of refine takes one more set into the mean of E and brings B up
 * to date: other points of texels and rectangles, other directions. So E approaches its mean over each texel and
 * the integral over lights while nothing moves; after a change of lights it relights, that is, begins again.
 * Highlights and surroundings keep the first set. Allocates in the first call alone.
 * Errors: those of relighting. Threads: the context's thread. */
parian_result parian_renderer_refine(parian_renderer *renderer);
/* Sets in E so far; 0 where the lights changed since. */
uint32_t parian_renderer_set_count(const parian_renderer *renderer);

/* Column-major matrices as OpenGL takes them. */
typedef struct parian_camera {
    float view[16];
    float projection[16];
} parian_camera;

typedef enum parian_tone {
    PARIAN_TONE_NEUTRAL = 0, /* identity below 0.76, then a shoulder that keeps hues (Khronos PBR Neutral) */
    PARIAN_TONE_LINEAR = 1,  /* clamped at 1 */
    PARIAN_TONE_REINHARD = 2 /* divided by 1 + luminance */
} parian_tone;

typedef struct parian_draw_desc {
    parian_camera camera;
    uint32_t width, height; /* pixels, 1 to 16384 */
    bool exposure_auto;     /* from the log-average luminance */
    float exposure_ev;      /* picture is scaled by 2^ev before the tone curve (after auto, if on) */
    parian_tone tone;
    /* GL: framebuffer that receives the tone-mapped sRGB picture (0: the default one); (uint32_t)-1: none. */
    uint32_t framebuffer;
} parian_draw_desc;

/* Relight if needed, shade, tone-map. Threads: the context's thread. */
parian_result parian_renderer_draw(parian_renderer *renderer, const parian_draw_desc *desc);

/* Pictures of the last draw, rows from top to bottom: linear radiance with coverage in alpha
 * [height * width][4], and 8-bit sRGB after exposure and tone curve [height * width][4]. Either may be NULL. */
parian_result parian_renderer_read_picture(parian_renderer *renderer, float (*radiance)[4], uint8_t (*srgb)[4]);

/* Per-texel arrays of the whole scene, bodies one after the other, owned texels only, SI units, world space. Each
 * may be NULL. local + global = radiosity (before the surface texture). Relights if needed. */
typedef struct parian_texel_arrays {
    uint32_t instance; /* of which instance; 0: the first */
    float (*position)[3];
    float (*normal)[3];     /* that E is taken at: of the source surface where the asset holds it */
    float *area;
    uint32_t (*place)[2];   /* column and row in the atlas of the body */
    uint32_t *chart;        /* below chart_count of the body */
    float (*irradiance)[3]; /* E, transmitted, W m^-2 */
    float (*radiosity)[3];  /* B, W m^-2 */
    float (*radiosity_local)[3];
    float (*radiosity_global)[3];
} parian_texel_arrays;
parian_result parian_renderer_read_texels(parian_renderer *renderer, const parian_texel_arrays *arrays);

/* ---- textures for a host that shades the bodies itself ------------------------------------------- */

/* GL textures of one body of one instance: GL_TEXTURE_2D, GL_RGBA32F, size x size, nearest look-up, one level.
 * Alpha is 1 at owned texels and gutters, where there is a value; elsewhere all is 0, so that rgb / a of a bilinear
 * look-up is right up to the edge of every chart. Floats are filtered by the hardware in OpenGL, and with
 * GL_OES_texture_float_linear in OpenGL ES: bind a sampler object of yours with GL_LINEAR; otherwise filter by hand
 * with texelFetch. Do not change the textures or their parameters, nor delete them.
 *
 *   #version 330 core                     // of a host: corner_uv / atlas_size in, radiance out
 *   uniform sampler2D u_radiosity, u_albedo;      // u_albedo where there is one
 *   uniform float u_eta, u_exit_norm;
 *   uniform vec3 u_tint;
 *   vec3 look_up(sampler2D map, vec2 uv) { vec4 v = texture(map, uv); return v.rgb / max(v.a, 1e-6); }
 *   ...
 *   vec3 radiance = transmit(dot(n, view), u_eta) * look_up(u_radiosity, uv) * look_up(u_albedo, uv)
 *                   * u_tint / (3.14159265 * u_exit_norm);
 *
 * with transmit the unpolarised Fresnel transmittance from outside. This is what parian_renderer_draw shows without
 * specular lobe, normal map, exposure and tone curve. */
typedef struct parian_gl_textures {
    uint32_t irradiance; /* E: transmitted, cosine and Fresnel applied, W m^-2 */
    uint32_t radiosity;  /* B: scattered, before the surface texture, W m^-2 */
    uint32_t albedo;     /* T_p, linear; 0: the body has none */
    uint32_t normal_map; /* unit normals in the space of the vertices; 0: the body has none */
    uint32_t size;       /* side of all of them, texels */
    float model[16], scale; /* where the instance stands, column-major */
    float eta, exit_norm;   /* relative index; C of L = F_t B T_p tint / (pi C) */
    float tint[3];          /* of a medium edit; 1, 1, 1 without */
} parian_gl_textures;

/* Relights if needed. E and B change in place whenever a later call relights (parian_renderer_relight, draw,
 * read_texels): relight once a frame, before your own passes. Names stay valid until other instances are set or the
 * renderer is destroyed; the first hand-out of a body of an instance allocates its B (16 bytes a texel of the atlas).
 * Other contexts may use the names where they share objects with this one, after a glFinish or a fence.
 * Errors: PARIAN_E_ARGUMENT, PARIAN_E_UNSUPPORTED (C evaluation), PARIAN_E_NOMEM, PARIAN_E_DEVICE. */
parian_result parian_renderer_get_gl_textures(parian_renderer *renderer, uint32_t instance, uint32_t body,
                                              parian_gl_textures *textures);

/* Time of each pass in the last relight and draw: milliseconds until the work was finished (GL: with a
 * glFinish around each pass when timing is on, which slows the whole). */
typedef struct parian_pass_time {
    const char *name; /* "shadow", "irradiance", "restrict", "product", "filter", "gutter", "shade", "tone" */
    double ms;
    uint64_t runs; /* since the renderer was created: proves what was recomputed */
} parian_pass_time;
enum { PARIAN_PASS_MAX = 16 };
void parian_renderer_set_timing(parian_renderer *renderer, bool on);
size_t parian_renderer_get_times(const parian_renderer *renderer, parian_pass_time times[PARIAN_PASS_MAX]);

/* ---- GL memory and uploads --------------------------------------------------------------------- */

/* Bytes of textures and buffers as this library asks for them; a driver may round up (many keep three
 * 16-bit components as four). */
typedef enum parian_memory_part {
    PARIAN_MEMORY_FACTORS = 0, /* operators: factors and their lists */
    PARIAN_MEMORY_KERNELS = 1, /* of the local part, with the lists of border texels */
    PARIAN_MEMORY_ATLAS = 2,   /* arrays by texel: surface, gutter */
    PARIAN_MEMORY_MESHES = 3,
    PARIAN_MEMORY_INSTANCES = 4, /* E, B and registers of each instance */
    PARIAN_MEMORY_LIGHTS = 5,  /* tables and projected pictures */
    PARIAN_MEMORY_SHADOWS = 6,
    PARIAN_MEMORY_PICTURE = 7, /* samples, depth, pictures and sums of the picture's size */
    PARIAN_MEMORY_PART_COUNT = 8
} parian_memory_part;

typedef struct parian_memory {
    uint64_t bytes[PARIAN_MEMORY_PART_COUNT];
    uint64_t total;
} parian_memory;

/* GL memory in use: all of it, and by part. 0 with the C evaluation. */
uint64_t parian_renderer_memory(const parian_renderer *renderer);
parian_memory parian_renderer_get_memory(const parian_renderer *renderer);

typedef struct parian_memory_desc { /* zero is default */
    const parian_light *lights; /* NULL: none */
    size_t light_count;
    uint32_t instance_count; /* 0: one */
    uint32_t width, height;  /* of pictures; 0: none are drawn */
    bool refined;            /* with what parian_renderer_refine takes in its first call */
} parian_memory_desc;

/* What a renderer with this desc would use, before it exists and without any GL; desc may be NULL. Counts the
 * smaller shadow maps that a budget enforces, but refuses nothing. Errors: PARIAN_E_ARGUMENT, PARIAN_E_NOMEM,
 * and those of parian_renderer_set_lights. */
parian_result parian_renderer_estimate_memory(const parian_env *env, const parian_scene *scene,
                                              const parian_renderer_desc *renderer,
                                              const parian_memory_desc *desc, parian_memory *memory);

/* Upload about max_bytes more (0: everything) of a renderer with deferred_upload, and tell in *bytes_left (may
 * be NULL) what is left. A slice is at least a row of a texture, at most 256 kB; kernels that are rebuilt at
 * load are computed in one go by the slice that needs them first. Until nothing is left, what relights, draws or
 * reads results is PARIAN_E_ARGUMENT. After an error the next call tries again where this one failed.
 * Errors: PARIAN_E_NOMEM, PARIAN_E_UNSUPPORTED, PARIAN_E_DEVICE. */
parian_result parian_renderer_upload(parian_renderer *renderer, uint64_t max_bytes, uint64_t *bytes_left);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif
