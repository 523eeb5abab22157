/* SPDX-License-Identifier: GPL-3.0-or-later */
/* skelfield simulate: particles in the gravity of a scene's bodies, or bodies that move. */
#include "run_bodies.h"
#include "run_particles.h"

static int run(cli *c) {
  skf_scene *scene = NULL;
  team crew;
  int status = team_join(&crew);
  if (status != CLI_DONE) return status;
  const char *path = cli_operand(c, 0);
  status = cli_scene(c, path, &scene);
  bool move = status == CLI_DONE && bodies_move(scene);
  if (move && crew.size > 1)
    status = cli_fail(CLI_BAD, "%s: bodies move, which %d processes cannot share, expected one", path, crew.size);
  if (status != CLI_DONE)
    status = team_meet(&crew, status, 0);
  else
    status = move ? run_bodies(c, scene) : run_particles(c, scene, &crew);
  team_leave(&crew);
  skf_scene_free(scene);
  return status;
}

static const cli_option options[] = {
    {'o', "output", "FILE", "the trajectory, .csv or .h5 (default: CSV on stdout)"},
    {'c', "contacts", "FILE", "the contact log, CSV"},
    {'a', "approach", "FILE", "where each particle came closest to each body, CSV"},
    {'g', "ground-track", "BODY", "add lat, lon [deg] and height over this body's ellipsoid, in its turning frame"},
    {'i', "invariants", NULL, "add energy, Jacobi constant and angular momentum of each particle to each row"},
    {'f', "frame", "FRAME", "of rows and contacts: inertial, or body, which turns (default: the scene's, inertial)"},
    {'m', "contact-map", "MAP.png", "a picture of where on a body contacts lie, by latitude and longitude"},
    {0, "contact-bins", "BINS.csv", "the same as a table"},
    {0, "map-body", "BODY", "of these two (default: the first body)"},
    {0, "map-step", "DEG", "height of the bins of these two (default: 5)"},
    {0, "map-quantity", "NAME", "that the picture shows: density (default) or speed"},
    {'b', "bodies", "FILE", "rows of the bodies that move, CSV (default: stdout)"},
    {'k', "checkpoint", "FILE", "keep the run's state there (and rows in FILE.journal), now and then and on Ctrl-C"},
    {'s', "every-seconds", "S", "between two checkpoints (default: 60)"},
    {'r', "resume", "FILE", "go on from that checkpoint; with --checkpoint of the same name begin if there is none"},
    {'j', "json", NULL, "print the summary as JSON on stdout"},
};

static const char notes[] =
    "in:  a scene with particles, or bodies that have `motion`, and a simulation\n"
    "out: t,particle,x,y,z,vx,vy,vz at t = 0, output_every, ..., t_end, by time, then particle; inertial frame.\n"
    "     HDF5: t (T), position and velocity (T, N, 3), place (T, N, 3), particles, bodies, contacts, scene;\n"
    "     attributes program, version, frame, seed of each source that draws, seeded: its first particle and how many\n"
    "invariants: energy,jacobi,lx,ly,lz,l_axis (HDF5: invariants, (T, N, 6)), per unit mass, constant or not: kinetic\n"
    "     + potential energy (of bodies and pushes); that less spin . angular momentum, where all bodies spin alike;\n"
    "     the angular momentum about a point of the axis of symmetry, else of spin, else the origin; its part along\n"
    "     the axis of symmetry. nan where there is none. The summary tells those that are constant with their drift,\n"
    "     and warns of one beyond steps * tolerance + 64 eps sqrt(steps + 1) relative to kinetic + |potential| energy\n"
    "     (momentum: to |r| |v|). Of particles that attract each other it tells those of all with a mass together;\n"
    "     the columns are those of each one in the bodies' field alone\n"
    "mass: particles with one attract all others (not the bodies): a direct sum, one step for all of them, by\n"
    "     gauss-radau, softened on request (simulation: {softening}); the bodies' own fields are never softened\n"
    "frame: in that of the body that spins, velocities are relative to it; times and invariants are the same\n"
    "contacts: t,particle,body,x,y,z,nx,ny,nz,vx,vy,vz,outcome: the first point where a path enters a body, the\n"
    "     outward normal, the velocity just before, and what follows:\n"
    "     stop    stays at that point of the inertial frame with velocity 0; rows go on\n"
    "     stick   stays at that point of the body and turns with it\n"
    "     bounce  rebounds: the normal velocity relative to the turning ground times -restitution, the tangential one\n"
    "             less friction times the normal impulse\n"
    "     slide   a rebound too low to tell (some hundred roundings of the place): slides on along the surface, or\n"
    "             along the groove between two, under all forces, with friction times the reaction against the slip,\n"
    "             until the ground falls away faster than it does, it meets another body, or friction stops it\n"
    "     rest    without speed along the ground, after an impact or a slide, held by friction: stays on the body\n"
    "             (particles with a mass slide by hops of 1e-6 of the body's size); also between grounds that move\n"
    "             differently, if there is friction\n"
    "     absorb  is gone: no rows at or after that time (HDF5: NaN)\n"
    "     pass    flies through, told at each entry\n"
    "     A particle that starts inside of a body flies freely until it leaves it.\n"
    "approach: particle,body,t,x,y,z,distance,level: up to the first contact, the place of largest level = F - iso (0\n"
    "     at a contact; any place inside), and the surface's distance from there to first order (0 inside); "
    "certified.\n"
    "     Not for particles with a mass. In the frame of the rows\n"
    "contact map: contacts with one body, bounces and passes too, by latitude and longitude in its own frame, spin\n"
    "     taken out: geodetic on its ellipsoid, or else those of the direction from a centre: poles on the axis of\n"
    "     spin (or along z), centre at the middle of the skeleton (there on the axis). A donut or a star has several\n"
    "     places in one direction: they share a bin. Bins are about equally large, fewer towards the poles; speed is\n"
    "     that relative to the ground, mean of the bin, nan without contacts.\n"
    "     table: lat_min,lat_max,lon_min,lon_max,count,speed, from the south, then the west [deg]\n"
    "search: certified misses no contact and invents none, up to rounding; fast stops at eighths of a step, promises\n"
    "     nothing for what a path enters for less than that, and is cheaper only close to surfaces that spin or are\n"
    "     thin; else both cost about the same\n"
    "bodies: t,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz: center of mass, attitude (a quaternion; a point p of the\n"
    "     scene is at x + R (p - x at t = 0)), velocity, angular velocity, all inertial. Bodies attract each other\n"
    "     (gravity: {G}), are pushed (forces: push), collide with restitution and friction, slide, roll and come to\n"
    "     rest on each other, gaps being 1e-9 to 1e-6 of their size, and their hits are rows of\n"
    "     t,body,other,x,y,z,nx,ny,nz,jx,jy,jz,closing: place, normal and impulse towards the other,\n"
    "     speed of approach\n"
    "checkpoints: a resumed run ends with the same bytes as one that was not interrupted; the outputs are written\n"
    "     when it ends, from the journal. What ended, even by kill -9, loses at most what was done since the last\n"
    "     checkpoint. The scene and the program must be the same; threads and outputs may differ.\n"
    "processes: mpirun -n N skelfield simulate SCENE ... flies a share of the particles in each; the first process\n"
    "     has the outputs, whose bytes are those of one process. HDF5 without a checkpoint is written by all of them,\n"
    "     each its part of the rows, where the build has the HDF5 of Open MPI and they see the same folder. Started\n"
    "     with a checkpoint, a run may go on with another number. mpirun kills a run one second after Ctrl-C:\n"
    "     --mca odls_base_sigkill_timeout 60 gives it time to end in order. SKELFIELD_MPI=off in the environment:\n"
    "     each process works by itself, on its own files.\n"
    "launch: a start on a body's ellipsoid; its speed is relative to the turning ground.\n"
    "example: skelfield simulate data/donut.yaml -o orbits.csv --contacts contacts.csv";

static const char *const writes[] = {"output", "contacts", "approach", "contact-map", "contact-bins", "bodies", NULL};

const cli_command cmd_simulate = {
    .name = "simulate",
    .operands = "SCENE",
    .summary = "fly the scene's particles, find their contacts",
    .operand_count = 1,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .notes = notes,
    .run = run,
    .shares = true,
    .writes = writes,
};
