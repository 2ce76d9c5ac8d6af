/* gl_state.h - everything that a renderer holds in its GL context.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_GL_STATE_H
#define PARIAN_GL_STATE_H

#include "gl/gl_body.h"
#include "gl/gl_device.h"

enum { GL_REDUCTION_MAX = 8 };

/* Targets of a picture of one size. */
typedef struct gl_picture {
    uint32_t width, height, side; /* pixels; samples along a side of one */
    GLuint framebuffer, depth;
    uint64_t depth_size;
    gl_texture samples, picture, srgb;
    gl_texture reduction[GL_REDUCTION_MAX]; /* ever smaller sums, 8 x 8 to one */
    int reduction_count;
    gl_texture mean, logs; /* 1 x 1 */
} gl_picture;

typedef struct gl_state {
    gl_device device;
    gl_body *body;        /* [body_count] */
    gl_lit *lit;          /* [lit_count * body_count] bodies of an instance one after the other */
    uint32_t lit_count;   /* instances that there is room for */
    gl_mesh *surrounding; /* [surrounding_count] */
    gl_texture light, layer, image, shadow;
    gl_texture tree, caster; /* what casts shadows, and where it stands */
    gl_texture set_light;    /* samples of the set that is added */
    float (
        *scratch)[4]; /* room for an atlas, or a table of samples; from the first refinement on */
    GLuint shadow_framebuffer;
    gl_picture picture;
    gl_body_source *source; /* [body_count], while the scene is uploaded */
    gl_upload_list upload;
} gl_state;

/* gl_light.c: upload the light tables and pictures; draw the shadow maps; set what
 * shaders/lights.glsl reads. */
void gl_lights_count(const parian_light_list *list, parian_memory *memory);
parian_result gl_lights_upload(parian_renderer *renderer);
parian_result gl_shadow_run(parian_renderer *renderer);
/* scale: of the instance that is lit, 1 for surroundings. */
void gl_pass_lights(const parian_renderer *renderer, float scale);

/* gl_sets.c: where casters stand; samples of a set and starts of its rays; E of
 * all bodies of all instances. */
void gl_casters_count(uint32_t count, parian_memory *memory);
void gl_sets_count(const parian_scene_data *scene, parian_memory *memory);
void gl_sets_destroy(parian_renderer *renderer);
parian_result gl_casters_upload(parian_renderer *renderer);
parian_result gl_set_upload(parian_renderer *renderer, uint32_t set);
void gl_irradiance_run(parian_renderer *renderer);
void gl_irradiance_refine(parian_renderer *renderer, uint32_t set);

/* gl_transfer.c: the passes from E to the shown atlases, each for all bodies of all instances. */
void gl_restrict_run(parian_renderer *renderer);
void gl_product_run(parian_renderer *renderer);
void gl_filter_run(parian_renderer *renderer);
void gl_gutter_run(parian_renderer *renderer);
void gl_gutter_run_one(parian_renderer *renderer, uint32_t instance, uint32_t body);

/* gl_picture.c. Counted for a context whose textures have at least 16384 texels a side. */
void gl_picture_count(uint32_t width, uint32_t height, parian_memory *memory);
parian_result gl_picture_prepare(parian_renderer *renderer, uint32_t width, uint32_t height);
void gl_picture_destroy(gl_device *device, gl_picture *picture);
void gl_shade_run(parian_renderer *renderer, const parian_draw_desc *desc);
void gl_tone_run(parian_renderer *renderer, const parian_draw_desc *desc);

#endif
