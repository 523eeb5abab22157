/* SPDX-License-Identifier: MIT */
/* The kernel itself: what its description promises. Cells tagged raises-exception are meant to fail. */
// %% [markdown]
// # The kernel
// Text, with *emphasis*.

// %%
double scale = 1;
double scaled(double x) { return scale * x * x; }

// %%
scale = 3;
printf("variables are shared: %g\n", scaled(2));

// %%
double scaled(double x) { return -scale * x; } // defined again

// %%
printf("the newest function: %g\n", scaled(2));

// %%
struct pair {
  int a;
};

// %%
struct pair {
  int a, b;
};

// %%
struct pair pair = {1, 2};
nb_require(pair.b == 2);
printf("the newest struct: %d\n", pair.b);

// %% tags=raises-exception
int *nowhere = NULL;
*nowhere = 1;

// %% tags=raises-exception
nb_require(1 > 2);

// %% tags=raises-exception
no_such_function();

// %% tags=raises-exception
int half(int a) { return a / 2; }
printf("%d\n", half(2));

// %% tags=raises-exception
nb_run("false");

// %%
/* the smallest PNG: one grey pixel */
static const unsigned char png[] = {137, 80, 78, 71, 13, 10, 26, 10,  0,   0,  0,   13, 73,  72,  68,  82, 0,
                                    0,   0,  1,  0,  0,  0,  1,  8,   0,   0,  0,   0,  58,  126, 155, 85, 0,
                                    0,   0,  10, 73, 68, 65, 84, 120, 218, 99, 104, 0,  0,   0,   130, 0,  129,
                                    218, 69, 8,  59, 0,  0,  0,  0,   73,  69, 78,  68, 174, 66,  96,  130};
FILE *file = fopen("dot.png", "wb");
fwrite(png, sizeof png, 1, file);
fclose(file);
printf("before the picture\n");
nb_show("dot.png");
printf("after the picture, scale is still %g\n", scale);

// %% tags=raises-exception
exit(5);

// %%
printf("after the death: %g\n", scale);
