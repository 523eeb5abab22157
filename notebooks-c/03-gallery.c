/* SPDX-License-Identifier: MIT */
/* The scenes of data/, drawn. notebooks-c/run executes this file and makes a page of it. */
// %% [markdown]
// # A gallery
//
// Skeletons with their surfaces: what the program draws of the scenes in `data/`, in the spirit of the figures of
// Sherstyuk's thesis (1999). Every picture is small, so that the page is made quickly; `--size` makes it larger. The
// times at the end are processor times of the whole command, reading and writing included.

// %%
#include "skelfield/skelfield.h"
#include <sys/resource.h>

enum { MOST = 32 };
struct {
  char name[64];
  double seconds;
} drawn[MOST];
int count;

double children(void) {
  struct rusage r;
  getrusage(RUSAGE_CHILDREN, &r);
  return (double)(r.ru_utime.tv_sec + r.ru_stime.tv_sec) + 1e-6 * (double)(r.ru_utime.tv_usec + r.ru_stime.tv_usec);
}

/* Draws data/SCENE.yaml into NAME.png with these options. */
void draw(const char *scene, const char *name, const char *size, const char *options) {
  char file[96];
  double before = children();
  snprintf(file, sizeof file, "%s.png", name);
  nb_run("skelfield render data/%s.yaml -o %s --size %s %s", scene, file, size, options);
  nb_show(file);
  snprintf(drawn[count].name, sizeof drawn->name, "%s", name);
  drawn[count++].seconds = children() - before;
}

// %% [markdown]
// ## Blending
//
// Starfishes with five to nine arms, each an arc of the Cauchy kernel. Then two segments in a T: the radius grows from
// below, and the blobbiness goes from hard at the left to soft at the right [Sherstyuk 1999, section 3.3.2].

// %%
draw("starfishes", "starfishes", "320x240", "--spp 4");
draw("t-shapes", "t-shapes", "320x240", "--spp 4");
draw("icicle", "icicle", "240x240", "--spp 4 --azimuth 10 --elevation 5");

// %% [markdown]
// ## The skeleton, and its offsets
//
// The skeleton inside of its surface; the hard surfaces around the skeleton that a modeller looks at while the skeleton
// grows, and the surface that blends them.

// %%
draw("starfish", "skeleton", "200x150", "--spp 2 --skeleton");
draw("coral", "coral-offset", "320x240", "--spp 4 --mode offset");
draw("coral", "coral", "320x240", "--spp 4");

// %% [markdown]
// ## Detail
//
// Spines that taper by a profile, a shell of points that grow on a spiral, and triangles each by itself, whose ball is
// wrinkled along their edges. A sphereflake with arcs for stems: its two colours are mixed by what each element adds to
// the field.

// %%
draw("urchin", "urchin", "200x150", "--quality draft --spp 4");
draw("shell", "shell", "320x240", "--spp 4");
draw("wrinkles", "wrinkles", "140x105", "--quality draft");
draw("flake91", "flake91", "320x240", "--spp 4");

// %% [markdown]
// Larger flakes are grown when they are needed: nine times as many balls in each step.

// %%
nb_run("python3 data/grow.py flake820 > flake820.yaml");
nb_run("skelfield render flake820.yaml -o flake820.png --quality draft --size 320x240");
nb_show("flake820.png");

// %% [markdown]
// ## Materials
//
// Glass, and one surface that goes from gold to wood to marble.

// %%
draw("still-life", "still-life", "240x180", "--spp 2");

// %% [markdown]
// ## Where the time goes
//
// Evaluations of the field along the ray through each pixel: silhouettes cost more than the rest, but not much more.

// %%
draw("starfish", "cost", "320x240", "--mode cost");

// %%
double sum = 0;
printf("%-14s %s\n", "picture", "seconds");
for (int i = 0; i < count; i++) {
  printf("%-14s %7.2f\n", drawn[i].name, drawn[i].seconds);
  nb_require(drawn[i].seconds > 0);
  sum += drawn[i].seconds;
}
printf("%-14s %7.2f\n", "all", sum);
