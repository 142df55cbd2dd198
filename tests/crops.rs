//! Models written as crop modellers write them: several files, organs with methods and bodies, ancestry queries,
//! aggregates, settings in instance scope. What they print is worked out by hand.

#![allow(clippy::unwrap_used, reason = "a helper that fails fails its test")]

#[path = "support/models.rs"]
mod models;
use models::Model;

/// What a model of these files prints in `init` and so many steps.
#[track_caller]
fn check(files: &[(&str, &str)], steps: u64, expected: &[&str]) {
    let model = Model::of_files(files).unwrap_or_else(|errors| panic!("{errors:#?}"));
    let printed = model.grown(steps).unwrap_or_else(|fault| panic!("{fault}"));
    assert_eq!(printed.printed().lines().collect::<Vec<_>>(), expected);
}

const PARAMETERS: (&str, &str) = (
    "parameters.rgg",
    "const int nPlants = 3; const float phyllochron = 2; static float specificArea = 0.02;
     static float[][] shares = {{0.6, 0.3}, {0.1, 0.2}}; static int rank = 0;",
);

#[test]
fn light_is_shared_among_the_leaves_of_each_plant() {
    let organs = "import static parameters.*;
module Plant(int id) { float light; float demand() { return sum((* this (-->)+ Leaf *)[area]); } }
module Bud(int rank); module Internode(super.length) extends F(length, 0.01);
module Leaf(int rank, float area) { float light; int age;
  Plant owner() { return first((* this -ancestor-> Plant *)); }
  void grow() { area += area * shares[0][1]; age++; } }
";
    let main = "import static parameters.*; import static organs.*;
protected void init() [ Axiom ==> for (int i : 1:nPlants) ([Translate(i, 0, 0) Plant(i) Bud(1)]); ]
public void run() {
  [ Bud(r) ==> Internode(0.1) [RL(60) Leaf(r, 0.5 * r)] RH(137) Bud(r + 1); ]
  derive();
  for ((* p:Plant *)) { p.light = 10 * p.id; }
  for ((* l:Leaf *)) { Plant p = l.owner(); l.light = p.light * l.area / p.demand(); }
  println(sum((* Leaf *)[light]) + \" \" + count((* Leaf *)) + \" \" + max((* l:Leaf, (l.owner().id == 2) *).light));
  (* Leaf *).grow();
  println(first((* Leaf *)).owner().id + \" \" + Math.round(1000 * sum((* Leaf *)[area])));
}";
    let files = [PARAMETERS, ("organs.rgg", organs), ("main.rgg", main)];
    // Each plant has one leaf of 0.5 in step 1; the new leaf of step 2 has 1.0 beside 0.65.
    check(&files, 1, &["60.0 3 20.0", "1 1950"]);
    let model = Model::of_files(&files).unwrap().grown(2).unwrap();
    let printed = model.printed();
    let last: Vec<&str> = printed.lines().skip(2).collect();
    assert_eq!(last.len(), 2);
    assert!(
        last[0].starts_with("60.0") && last[0].contains(" 6 12.12"),
        "{last:?}"
    );
    assert_eq!(last[1], "1 6435");
}

#[test]
fn assimilates_run_down_and_up() {
    let model = "module Root(float pool); module I(int k) { float flow; } module Leaf(float gain); module Fruit(float mass, float sink);
protected void init() [ Axiom ==> Root(0) I(1) [Leaf(2)] I(2) [Leaf(3)] [Fruit(0, 1)] I(3) [Leaf(5)] [Fruit(0, 3)]; ]
public void run() {
  [ i:I ::> i[flow] := sum((* i (-->)* Leaf *)[gain]); ]
  derive();
  for ((* i:I *)) print(i.flow + \" \");
  println();
  [ r:Root ::> r[pool] := r[pool] + sum((* r (-->)+ Leaf *)[gain]); ]
  derive();
  float sinks = sum((* Fruit *)[sink]);
  [ f:Fruit, (f.sink > 0) ::> { Root r = first((* f (<--)+ Root *)); f[mass] :+= r.pool * f.sink / sinks; } ]
  derive();
  println(string((* Fruit *)[mass]));
  Fruit best = selectWhereMax((* f:Fruit *), f.mass);
  I bearer = first((* best <+ I *));
  println(bearer.k + \" \" + (* best *).sink);
}";
    check(
        &[("model.rgg", model)],
        1,
        &["10.0 8.0 5.0 ", "[2.5, 7.5]", "3 3.0"],
    );
}

#[test]
fn old_branches_are_shed_with_all_they_bear() {
    let model =
        "module I(int age); module Branch(int order, int age); module Leaf; module Bud(int order);
protected void init() [ Axiom ==> Bud(0); ]
public void run() {
  [ Bud(o), (o < 2) ==> I(0) [RU(50) Branch(o + 1, 0) Bud(o + 1)] [Leaf] Bud(o);
    b:Branch(o, a), (a < 2) ==> Branch(o, a + 1);
    I(a) ==> I(a + 1); ]
  derive();
  [ b:Branch(o, a), (a >= 2 && empty((* b -ancestor-> Branch *))) ==>> ; ]
  derive();
  println(count((* Branch *)) + \" \" + count((* Leaf *)) + \" \" + count((* I (* > I *) *)));
}";
    // Step 1: a stem of one internode with a branch. Step 2: a second one, and one on the branch. Step 3: the first branch
    // is two steps old and falls with its two side branches; what stays are those of 2 and 3 with one on 2.
    check(&[("model.rgg", model)], 3, &["1 1 0", "3 3 1", "3 4 2"]);
}

#[test]
fn neighbours_compete() {
    let model = "import java.util.*;
module Tree(int id, float size, float x) extends Null(x, 0, 0) { float crowding; boolean isLeader = false; }
static boolean isNear(Tree a, Tree b) { return a != b && Math.abs(a.x - b.x) < 1.5; }
static Tree tallest(Node any) { return selectWhereMax((* t:Tree *), t.size); }
protected void init() [ Axiom ==> for (int i : 1:5) ([Tree(i, i * i, i)]); ]
public void run() {
  for ((* t:Tree *)) {
    t[crowding] = sum((* t -isNear-> n:Tree *)[size]);
    t.isLeader = empty((* t -isNear-> n:Tree, (n.size > t.size) *));
  }
  println(string((* Tree *)[crowding]) + \" \" + count((* t:Tree, (t.isLeader) *)));
  println(first((* t:Tree -tallest-> b:Tree, (t.id == 2) *)).id);
  [ t:Tree, (t.crowding > 15) ==> ;
    (* t:Tree -isNear-> *) n:Tree, (t.isLeader && n.size < t.size) ==> ; ]
  derive();
  println(string((* Tree *)[id]));
  println(mean((* Tree *)[size]) + \" \" + (last((* Tree *)).(x += 10)).x);
}";
    check(
        &[("model.rgg", model)],
        1,
        &["[4.0, 10.0, 20.0, 34.0, 16.0] 1", "5", "[1, 2]", "2.5 12.0"],
    );
}
