/* renderer_internal.h - what a renderer holds, and what a backend (GL, C) must do for it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_RENDERER_INTERNAL_H
#define PARIAN_RENDERER_INTERNAL_H

#include "core/body.h"
#include "frame_memory.h"
#include "lights/light_list.h"
#include "lights/occluder_tree.h"
#include "method/edited_body.h"
#include "method/ray_origins.h"
#include "parian/runtime.h"
#include "placement.h"
#include "scene_internal.h"
#include "shade/body_optics.h"

/* Memory that all shadow maps of a renderer may take: 16 maps of 2048 x 2048. */
#define PARIAN_SHADOW_MEMORY_MAX ((uint64_t)256 << 20)
enum { PARIAN_SHADOW_SIZE_DEFAULT = 2048 };

typedef enum parian_pass {
    PARIAN_PASS_SHADOW,
    PARIAN_PASS_IRRADIANCE,
    PARIAN_PASS_RESTRICT,
    PARIAN_PASS_PRODUCT,
    PARIAN_PASS_FILTER,
    PARIAN_PASS_GUTTER,
    PARIAN_PASS_SHADE,
    PARIAN_PASS_TONE,
    PARIAN_PASS_COUNT
} parian_pass;

/* Per-texel results of a body. */
typedef enum parian_texel_result {
    PARIAN_RESULT_IRRADIANCE,
    PARIAN_RESULT_LOCAL,
    PARIAN_RESULT_GLOBAL
} parian_texel_result;

/* A backend's functions; state is renderer->state. */
typedef struct parian_backend_table {
    /* What all instances share; resize follows. */
    parian_result (*create)(parian_renderer *renderer);
    void (*destroy)(parian_renderer *renderer);
    /* Hold the results of so many instances; after an error those of as many as before. */
    parian_result (*resize)(parian_renderer *renderer, uint32_t instance_count);
    /* Make shadow maps, E, the registers, the local and global part, and their gutters, of all
     * instances, from a pass on: what earlier passes made is still right. */
    parian_result (*relight)(parian_renderer *renderer, parian_pass from);
    /* Take over another medium's factors, weights and kernels of one body; edited is then empty.
     * After PARIAN_E_DEVICE the body's transport is undefined. */
    parian_result (*edit)(parian_renderer *renderer, uint32_t body, parian_edited_body *edited);
    /* Take set `set` > 0 of samples (renderer->varied) into the mean of E, and what follows from E.
     */
    parian_result (*refine)(parian_renderer *renderer, uint32_t set);
    /* Shade where asked to (else the last linear picture is still right) and tone-map; keeps the
     * pictures. */
    parian_result (*draw)(parian_renderer *renderer, const parian_draw_desc *desc, bool shade);
    /* The linear picture of the last draw, rows from top to bottom; and the tone-mapped one. */
    parian_result (*read_picture)(parian_renderer *renderer, float (*radiance)[4],
                                  uint8_t (*srgb)[4]);
    /* A result at owned texels of one body of one instance: [texel_count]. */
    parian_result (*read_texels)(parian_renderer *renderer, uint32_t instance, uint32_t body,
                                 parian_texel_result which, float (*value)[3]);
    /* Values to paint on one body of every instance: [texel_count]. */
    parian_result (*set_values)(parian_renderer *renderer, uint32_t body, const float (*value)[3]);
    /* A register of one body of the first instance: [size of the register]; register 0 is Phi, 1
     * is B at vertices. */
    parian_result (*read_register)(parian_renderer *renderer, uint32_t body, uint32_t index,
                                   float (*value)[3]);
    /* Set the names of the textures of one body of one instance; NULL where there are none. */
    parian_result (*hand_out)(parian_renderer *renderer, uint32_t instance, uint32_t body,
                              parian_gl_textures *textures);
    parian_memory (*memory)(const parian_renderer *renderer);
    /* NULL where nothing is uploaded and no GL memory used: */
    /* Upload about max_bytes; the scene's bytes that are left go to renderer->upload_left. */
    parian_result (*upload)(parian_renderer *renderer, uint64_t max_bytes);
    /* Add what a scene takes; and what these lights and a picture (of width 0: none) take. */
    parian_result (*count_scene)(const parian_env *env, const parian_scene_data *scene,
                                 uint32_t instance_count, parian_memory *memory);
    void (*count_sets)(const parian_scene_data *scene, parian_memory *memory); /* of refinements */
    void (*count_frame)(const parian_light_list *list, uint32_t width, uint32_t height,
                        parian_memory *memory);
} parian_backend_table;

/* Where bodies and surroundings are: boxes, and balls around the boxes' middles; world space. */
typedef struct parian_bounds {
    float lower[3], upper[3]; /* of everything */
    parian_ball bodies, everything;
} parian_bounds;

/* The medium that a body has now, and what became of it. */
typedef struct parian_body_medium {
    parian_medium medium; /* with the size factor in its coefficients */
    parian_medium_report report;
    bool broken; /* an upload failed half-way */
} parian_body_medium;

extern const parian_backend_table parian_gl_backend, parian_cpu_backend;

enum { PARIAN_RENDERER_NAME_MAX = 256 };
struct parian_renderer {
    parian_env env; /* of frame_memory */
    parian_frame_memory frame_memory;
    const parian_scene *scene;
    parian_renderer_desc desc;
    const parian_backend_table *backend;
    void *state;
    char name[PARIAN_RENDERER_NAME_MAX];
    parian_settings settings;
    parian_light_list lights;
    parian_body_optics *optics;  /* [body_count] */
    float *relief_reach;         /* [body_count] parian_relief_reach */
    parian_body_medium *medium;  /* [body_count] */
    uint32_t instance_count;     /* at least 1 */
    parian_placement *instances; /* [instance_count] */
    parian_bounds bounds;        /* of all instances and the surroundings */
    bool lights_changed;         /* lights or instances, since the last relight */
    parian_pass edited_from;     /* first pass that an edit made stale; PARIAN_PASS_SHADE: none */
    uint32_t set_count;          /* sets of samples in E */
    parian_occluder_tree tree;
    uint32_t caster_count, caster_room;
    parian_caster *caster;       /* [caster_count] bodies of each instance, then surroundings */
    parian_texel_cover *cover;   /* [body_count] empty until the first refinement */
    float (*origin)[3];          /* room for the starts of one body's rays */
    parian_light_sample *varied; /* [PARIAN_LIGHT_MAX] samples of the set that is added */
    bool has_values;             /* to paint on the bodies */
    bool timing;
    double pass_start;
    parian_pass_time pass[PARIAN_PASS_COUNT];
    uint32_t picture_width, picture_height; /* of the last draw, 0 before */
    parian_camera picture_camera;
    bool picture_stale;   /* the last picture shows other light or settings */
    uint64_t upload_left; /* bytes of GL memory of the scene that are not uploaded yet */
};

/* Bracket a pass: counts its runs and, with timing on, its milliseconds. */
void parian_renderer_begin_pass(parian_renderer *renderer);
void parian_renderer_end_pass(parian_renderer *renderer, parian_pass pass);

/* refine.c: the tree, and rooms; casters where the instances stand; where rays of a body's texels
 * start in a set, [texel_count], until the next call. */
parian_result parian_renderer_prepare_sets(parian_renderer *renderer);
parian_result parian_renderer_place_casters(parian_renderer *renderer);
void parian_renderer_free_sets(parian_renderer *renderer);
const float (*parian_renderer_origins(parian_renderer *renderer, uint32_t body, uint32_t set))[3];

/* Number of registers that a body's operators use (at least 2), and the size of one. */
uint32_t parian_body_register_count(const parian_body *body);
uint32_t parian_body_register_size(const parian_body *body, uint32_t index);

/* renderer_memory.c: refuse a scene that the budget cannot hold, naming its parts. */
parian_result parian_renderer_check_scene(const parian_renderer *renderer,
                                          const parian_memory *scene);
/* Place the shadow maps of a list around all instances, as large as desc and budget allow. */
parian_result parian_renderer_fit_shadows(parian_renderer *renderer, parian_light_list *list);
/* Make shadow maps smaller until they, the scene and a picture (width 0: none) stay within the
 * budget; *smaller tells whether they changed. Errors: PARIAN_E_NOMEM; the list is then unchanged.
 */
parian_result parian_renderer_fit_budget(parian_renderer *renderer, parian_light_list *list,
                                         uint32_t width, uint32_t height, bool *smaller);
/* PARIAN_E_ARGUMENT while the scene is not uploaded. */
parian_result parian_renderer_check_uploaded(const parian_renderer *renderer);

/* Distance by which a shaded point is lifted along its normal before shadow look-ups, metres,
 * beyond what the shadow texel asks for; scale: of its instance, 1 for surroundings. */
float parian_renderer_shadow_lift(const parian_renderer *renderer, float scale);

/* renderer_medium.c: media and optics as baked. Errors: PARIAN_E_NOMEM. */
parian_result parian_renderer_start_media(parian_renderer *renderer);

/* renderer_instances.c: one instance where the file has it. Errors: PARIAN_E_NOMEM. */
parian_result parian_renderer_start_instances(parian_renderer *renderer);

/* Tests: a register of a body of the first instance after relighting. */
parian_result parian_renderer_read_register(parian_renderer *renderer, uint32_t body,
                                            uint32_t index, float (*value)[3]);

#endif
