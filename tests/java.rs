//! Expressions of Java with the texts that JDK 17 printed for them: promotion, rounding, overflow, casts, texts, library.

#![allow(clippy::unwrap_used, reason = "a helper that fails fails its test")]

use std::sync::{Arc, Mutex};

use understory::check::{SourceModel, check};
use understory::diag::FileId;
use understory::growth::{Growth, GrowthOptions};
use understory::syntax::parse;

#[rustfmt::skip]
const EXPRESSIONS: &[(&str, &str)] = &[
    ("7 / 2 * 2.0", "6.0"),
    ("-7 / 2", "-3"),
    ("-7 % 3", "-1"),
    ("7 % -3", "1"),
    ("-7.5 % 2", "-1.5"),
    ("5.5f % 2", "1.5"),
    ("Integer.MAX_VALUE + 1", "-2147483648"),
    ("Integer.MIN_VALUE / -1", "-2147483648"),
    ("Integer.MIN_VALUE % -1", "0"),
    ("Long.MIN_VALUE / -1L", "-9223372036854775808"),
    ("-Integer.MIN_VALUE", "-2147483648"),
    ("Math.abs(Integer.MIN_VALUE)", "-2147483648"),
    ("1 << 33", "2"),
    ("1 << -1", "-2147483648"),
    ("1L << 33", "8589934592"),
    ("1L << 65", "2"),
    ("-16 >> 2", "-4"),
    ("-16 >>> 28", "15"),
    ("-16L >>> 60", "15"),
    ("-1 >>> 0", "-1"),
    ("(byte) 200", "-56"),
    ("(byte) -129", "127"),
    ("(short) 70000", "4464"),
    ("(char) 65", "A"),
    ("(char) 65.9", "A"),
    ("(int) 'z'", "122"),
    ("(char) ('a' + 1)", "b"),
    ("'a' + 'b'", "195"),
    ("\"\" + 'a' + 'b'", "ab"),
    ("'a' + 1 + \"x\" + 1 + 'a'", "98x1a"),
    ("(int) 3.99", "3"),
    ("(int) -3.99", "-3"),
    ("(int) 1e20", "2147483647"),
    ("(int) -1e20", "-2147483648"),
    ("(long) 1e20", "9223372036854775807"),
    ("(int) Double.NaN", "0"),
    ("(long) Float.POSITIVE_INFINITY", "9223372036854775807"),
    ("(byte) 300.7", "44"),
    ("(char) -1", "￿"),
    ("(short) 1e10", "-1"),
    ("(int) 4294967297L", "1"),
    ("(float) 0.1", "0.1"),
    ("(double) 0.1f", "0.10000000149011612"),
    ("0.1f + 0.2f", "0.3"),
    ("0.1 + 0.2", "0.30000000000000004"),
    ("0.1f + 0.2", "0.30000000149011613"),
    ("1 / 3f", "0.33333334"),
    ("1 / 3.0", "0.3333333333333333"),
    ("100 * 1.1f", "110.0"),
    ("1e10f * 1e10f", "1.0E20"),
    ("1e30f * 1e30f", "Infinity"),
    ("-1.0 / 0", "-Infinity"),
    ("0.0 / 0", "NaN"),
    ("1f / 0 == Float.POSITIVE_INFINITY", "true"),
    ("Double.NaN == Double.NaN", "false"),
    ("0.0 == -0.0", "true"),
    ("16777217", "16777217"),
    ("(float) 16777217", "1.6777216E7"),
    ("16777216f + 1f", "1.6777216E7"),
    ("(int) 16777217f", "16777216"),
    ("2147483647f", "2.14748365E9"),
    ("(int) 2147483647f", "2147483647"),
    ("9007199254740993L", "9007199254740993"),
    ("(double) 9007199254740993L", "9.007199254740992E15"),
    ("(long) 9007199254740993.0", "9007199254740992"),
    ("(float) 1e-50", "0.0"),
    ("1.0e-3", "0.001"),
    ("9.999e-4", "9.999E-4"),
    ("1e7", "1.0E7"),
    ("9999999.0", "9999999.0"),
    ("12345678.9", "1.23456789E7"),
    ("123456.789f", "123456.79"),
    ("1.0E-5f", "1.0E-5"),
    ("3.4e38f", "3.4E38"),
    ("5e-324", "4.9E-324"),
    ("100.0 / 3", "33.333333333333336"),
    ("(float) (100.0 / 3)", "33.333332"),
    ("5 > 3 == true", "true"),
    ("1 < 2 && 3 < 2 || true", "true"),
    ("true ^ false", "true"),
    ("6 & 3 | 8 ^ 2", "10"),
    ("~7", "-8"),
    ("~7L", "-8"),
    ("5 == 5.0", "true"),
    ("'a' == 97", "true"),
    ("1 + 2 + \"x\" + 1 + 2", "3x12"),
    ("\"a\" + null", "anull"),
    ("\"a\" + 1.0f + 2.0 + 3L + true + 'c'", "a1.02.03truec"),
    ("\"abc\".length() + \"abc\".charAt(1)", "101"),
    ("\"abc\".substring(1) + \"abcdef\".substring(1, 3)", "bcbc"),
    ("\"hello\".indexOf(\"l\") + \"hello\".lastIndexOf(\"l\") * 10", "32"),
    ("\"b\".compareTo(\"a\") + \"a\".compareTo(\"abc\")", "-1"),
    ("\"a,b,,c,,\".split(\",\").length", "4"),
    ("\"a,b,,\".split(\",\", -1).length", "4"),
    ("\"a,b,,\".split(\",\", 3).length", "3"),
    ("\"a,b,c\".split(\",\", 2)[1]", "b,c"),
    ("\",\".split(\",\").length", "0"),
    ("\"\".split(\",\").length", "1"),
    ("\" a b \".split(\"\\\\s+\").length", "3"),
    ("\" a b \".split(\"\\\\s+\", -1).length", "4"),
    ("\"a b c\".split(\"\\\\s+\", 2)[1]", "b c"),
    ("\"abc\".split(\"\", 2)[1]", "bc"),
    ("\"abc\".split(\"\", -1).length", "4"),
    ("\" x \".trim().equals(\"x\")", "true"),
    ("\"AbC\".toLowerCase() + \"AbC\".toUpperCase()", "abcABC"),
    ("\"banana\".replace(\"an\", \"x\")", "bxxa"),
    ("Math.round(2.5) + Math.round(-2.5)", "1"),
    ("Math.round(0.49999999999999994)", "0"),
    ("Math.round(-0.5f)", "0"),
    ("Math.floor(-1.5) + Math.ceil(-1.5)", "-3.0"),
    ("Math.rint(2.5) + Math.rint(3.5)", "6.0"),
    ("Math.max(-0.0, 0.0)", "0.0"),
    ("Math.min(-0.0, 0.0)", "-0.0"),
    ("Math.signum(-3.5)", "-1.0"),
    ("Math.sqrt(2)", "1.4142135623730951"),
    ("Math.pow(2, 0.5)", "1.4142135623730951"),
    ("Math.pow(2, -1)", "0.5"),
    ("Math.exp(1)", "2.718281828459045"),
    ("Math.exp(-2.5)", "0.0820849986238988"),
    ("Math.log(10)", "2.302585092994046"),
    ("Math.log(7.3)", "1.9878743481543455"),
    ("Math.log10(2)", "0.3010299956639812"),
    ("Math.cbrt(10)", "2.154434690031884"),
    ("Math.sin(1)", "0.8414709848078965"),
    ("Math.cos(2)", "-0.4161468365471424"),
    ("Math.tan(0.5)", "0.5463024898437905"),
    ("Math.atan2(1, 2)", "0.4636476090008061"),
    ("Math.asin(0.3)", "0.3046926540153975"),
    ("Math.hypot(3, 4)", "5.0"),
    ("Math.toRadians(30)", "0.5235987755982988"),
    ("Math.toDegrees(1)", "57.29577951308232"),
    ("Math.floorMod(-7, 3)", "2"),
    ("Math.floorDiv(-7, 3)", "-3"),
    ("Integer.toHexString(-1)", "ffffffff"),
    ("Integer.toBinaryString(10)", "1010"),
    ("Integer.parseInt(\"-42\") + 1", "-41"),
    ("Double.parseDouble(\"1e3\")", "1000.0"),
    ("Float.parseFloat(\"2.5\") * 2", "5.0"),
    ("Integer.MAX_VALUE * 2L", "4294967294"),
    ("Long.MAX_VALUE + 1", "-9223372036854775808"),
    ("1000000 * 1000000", "-727379968"),
    ("(5 / 2) * 2.0f", "4.0"),
    ("true ? 1 : 2.0", "1.0"),
    ("false ? 1 : 'a'", "a"),
    ("true ? 'b' : 0", "b"),
    ("(true ? null : \"s\")", "null"),
    ("10 - 4 - 3", "3"),
    ("2 + 3 * 4 - 6 / 4 % 2", "13"),
    ("-5 / 2 * 2 + -5 % 2", "-5"),
    ("1.0f * Integer.MAX_VALUE", "2.14748365E9"),
    ("(double) Long.MAX_VALUE", "9.223372036854776E18"),
    ("(float) Long.MAX_VALUE", "9.223372E18"),
    ("(long) (float) Long.MAX_VALUE", "9223372036854775807"),
    ("String.format(\"%.2f|%5d|%-5s|%05d\", 3.14159, 42, \"ab\", 7)", "3.14|   42|ab   |00007"),
    ("String.format(\"%e %x\", 12345.678, 255)", "1.234568e+04 ff"),
    ("new java.util.Random(7).nextInt(100)", "36"),
    ("new java.util.Random(7).nextLong()", "-4967725919621401576"),
    ("new java.util.Random(7).nextGaussian()", "0.8452060657049847"),
    ("new java.util.Random(7).nextDouble()", "0.7306990420600421"),
    ("\"x\".hashCode() + \"hello\".hashCode()", "99162442"),
];

/// What a model whose `init` has this body prints.
fn printed(body: &str) -> Result<String, String> {
    printed_by(&format!("protected void init() {{\n{body}\n}}"))
}

/// What a model prints at its start.
fn printed_by(text: &str) -> Result<String, String> {
    let (ast, read) = parse(FileId(0), text);
    let (model, checked) = check(&[SourceModel {
        name: "model.rgg".into(),
        ast,
    }]);
    if read.has_errors() || checked.has_errors() {
        return Err(format!("{read:#?} {checked:#?}"));
    }
    let printed = Arc::new(Mutex::new(String::new()));
    let sink = Arc::clone(&printed);
    let output = Box::new(move |text: &str| sink.lock().expect("one thread").push_str(text));
    let mut growth = Growth::new(&model, GrowthOptions::default(), output, Box::new(|| false))
        .map_err(|d| d.message)?;
    growth.init().map_err(|d| d.message)?;
    let printed = printed.lock().expect("one thread").clone();
    Ok(printed)
}

#[test]
fn expressions_print_what_java_prints() {
    let mut wrong = vec![];
    for (expression, expected) in EXPRESSIONS {
        match printed(&format!("println(\"\" + ({expression}));")) {
            Ok(found) if found.trim_end_matches('\n') == *expected => {}
            Ok(found) => wrong.push(format!("{expression}: {found} instead of {expected}")),
            Err(fault) => wrong.push(format!("{expression}: {fault}")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Classes, interfaces, constructors, exceptions of the model's own; what JDK 17 prints for the same classes.
const CLASSES: &str = r#"
class Point2 {
	double x = 1; double y;
	static int made;
	Point2() { made++; }
	Point2(double x, double y) { this(); this.x = x; this.y = y; }
	double norm() { return Math.sqrt(x*x + y*y); }
	String toString() { return "(" + x + "," + y + ")"; }
}
class Point3 extends Point2 {
	double z = 2;
	int[] a = {1,2,3};
	char c = 'q';
	Leaf leaf;
	Point3 next;
	Point3(double z) { super(3, 4); this.z += z; a[0]++; }
	double norm() { return super.norm() + z; }
}
class Oops extends Exception { int code; Oops(String m, int code) { super(m); this.code = code; } }
interface Grows { double grow(double by); }
class Twig implements Grows { double l; double grow(double by) { l += by; return l; } }
module Leaf(double size) extends F(size) implements Grows {
	double grow(double by) { size += 2 * by; return size; }
}
module Stem(int n) { float w; Stem(float w, int k) { this.w = w; n = k; } }
static double f(Grows g) { return g.grow(1); }
protected void init() {
	Point2 p = new Point2();
	println(p.norm() + " " + p.x);
	Point2 q = new Point3(5);
	println(q.norm() + " " + q.x + " " + Point2.made + " " + ((Point3) q).z + ((Point3) q).c + ((Point3) q).a[0]);
	Point3 r = (Point3) q;
	r.next = new Point3(1);
	r.next.x *= 2; r.next.x++;
	println(r.next.x + " " + (r.next == null) + " " + (r.next.next == null) + (q instanceof Point3) + (p instanceof Point3));
	r.leaf = new Leaf(0.5);
	println(r.leaf.size);
	try { throw new Oops("bad", 7); } catch (ArithmeticException e) { println("no"); } catch (Oops e) { println(e.getMessage() + e.code); }
	try { int z = 0; z = 1 / z; } catch (NullPointerException | ArithmeticException e) { println(e.getMessage()); }
	println(f(new Twig()) + " " + f(r.leaf));
	Stem s = new Stem(2.5, 9);
	println(s.w + " " + s.n + " " + new Stem(3).n);
	println("p = " + p + " " + q);
	p = null;
	println("null: " + p);
}
"#;

#[test]
fn classes_work_as_in_java() {
    let expected = "1.0 1.0\n12.0 3.0 2 7.0q2\n7.0 false truetruefalse\n0.5\nbad7\n/ by zero\n1.0 2.5\n2.5 9 3\n\
                    p = (1.0,0.0) (3.0,4.0)\nnull: null\n";
    assert_eq!(printed_by(CLASSES).unwrap(), expected);
}

const REPEATED: &str = r#"
module A(int v) { void hop() { print(v + " "); } }
protected void init() {
	[ Axiom ==> A(1) A(2); ]
	derive();
	(* A *).hop();
	(* A *)[v] += 3;
	((* A *)).hop();
	println((* A *)[v]);
	(* A *)[v]++;
	(* a:A, (a.v > 5) *).v = 9;
	(* A *).hop();
	int s = 0;
	s += (* A *).v;
	s *= (2:3);
	println(s);
	(* A *)[v] :+= 10;
	derive();
	(* A *).hop();
	(* A(0) *).hop();
}
"#;

/// A statement with a query in it is a loop, as in XL; one that would keep the last value only is refused.
#[test]
fn statements_are_done_for_each_value() {
    let expected = "1 2 4 5 4\n5\n5 9 84\n15 19 ";
    assert_eq!(printed_by(REPEATED).unwrap(), expected);
    let slips = [
        "int s = 0; s = (* A *).v;",
        "int s = (* A *).v;",
        "(* A *);",
    ];
    for slip in slips {
        let text = REPEATED.replace("(* A(0) *).hop();", slip);
        let error = printed_by(&text).expect_err(slip);
        assert!(
            error.contains("several values") || error.contains("does nothing"),
            "{slip}: {error}"
        );
    }
}

/// Collections and texts; what JDK 17 prints for the same statements.
const STATEMENTS: &[(&str, &str)] = &[
    (
        "HashMap m = new HashMap(); String[] k = {\"zeta\", \"alpha\", \"beta\", \"x\", \"leaf\"}; for (int i = 0; i < 5; i++) m.put(k[i], i); println(m);",
        "{zeta=0, alpha=1, x=3, leaf=4, beta=2}",
    ),
    (
        "HashSet s = new HashSet(); for (int i = 40; i > 0; i -= 3) s.add(i); println(s + \" \" + s.size() + s.contains(7));",
        "[1, 34, 4, 37, 7, 40, 10, 13, 16, 19, 22, 25, 28, 31] 14true",
    ),
    (
        "LinkedHashMap m = new LinkedHashMap(); m.put(\"b\", 1); m.put(\"a\", 2); println(m + \" \" + m.keySet());",
        "{b=1, a=2} [b, a]",
    ),
    (
        "Stack s = new Stack(); s.push(1); s.push(2); println(s.pop() + \" \" + s.peek() + \" \" + s.empty());",
        "2 1 false",
    ),
    (
        "LinkedList l = new LinkedList(); l.addFirst(1); l.addLast(2); l.add(0); println(l.removeFirst() + \" \" + l.getLast() + l);",
        "1 0[2, 0]",
    ),
    (
        "Iterator i = Arrays.asList(new String[] {\"c\", \"a\"}).iterator(); while (i.hasNext()) print(i.next() + \";\"); println();",
        "c;a;",
    ),
    (
        "StringTokenizer t = new StringTokenizer(\"a,b;;c\", \",;\"); println(t.countTokens() + t.nextToken() + t.nextToken() + t.hasMoreTokens());",
        "3abtrue",
    ),
    (
        "double[] a = {3, 1.5, 2}; Arrays.sort(a); println(Arrays.toString(a)); Arrays.fill(a, 7.0); println(a[2]);",
        "[1.5, 2.0, 3.0]\n7.0",
    ),
    (
        "ArrayList l = new ArrayList(Arrays.asList(new String[] {\"b\", \"c\", \"a\"})); Collections.sort(l); Collections.reverse(l); println(l + \" \" + Collections.min(l));",
        "[c, b, a] a",
    ),
    (
        "println(\"a1b1\".replaceAll(\"1\", \"-\") + \"a1b1\".replaceFirst(\"1\", \"\") + \"x  y\".replaceAll(\"\\\\s+\", \"_\") + \"a;b,c\".split(\"[,;]\").length);",
        "a-b-ab1x_y3",
    ),
];

/// What the library of Java tells of texts, numbers and arrays; what JDK 17 prints for the same statements.
const LIBRARY: &[(&str, &str)] = &[
    (
        "println(String.format(\"%2$s %1$s\", \"a\", \"b\") + String.format(\"|%,d|%+.1f|%e|%g|%b|%c|%o\", 1234567, 2.25, 12345.678, 0.00012345, true, 'z', 8));",
        "b a|1,234,567|+2.3|1.234568e+04|0.000123450|true|z|10",
    ),
    (
        "println(String.format(\"%.2f %.2f %.0f %08.2f|%-7.1f|%(.1f\", 1.005, 0.125, 2.5, -3.14159, 2.0f, -1.5));",
        "1.01 0.13 3 -0003.14|2.0    |(1.5)",
    ),
    (
        "System.out.printf(\"%d %s%n\", 3L, null); System.out.printf(Locale.US, \"%.1f\", 0.25);",
        "3 null\n0.3",
    ),
    (
        "StringBuilder b = new StringBuilder(\"abc\"); b.append(1).insert(1, 2.5f).reverse(); b.setCharAt(0, 'x'); b.deleteCharAt(1).delete(1, 2).replace(0, 1, \"zz\"); println(b + \" \" + b.length() + b.charAt(1) + b.indexOf(\"2\") + b.substring(2));",
        "zz5.2a 6z45.2a",
    ),
    (
        "int[] a = {3, 1, 2}; int[] b = a.clone(); Arrays.sort(b); b[0] = 9; println(Arrays.toString(a) + Arrays.toString(b) + Arrays.toString(Arrays.copyOf(a, 5)) + Arrays.toString(Arrays.copyOfRange(a, 1, 2)) + Arrays.equals(a, b) + Arrays.hashCode(a));",
        "[3, 1, 2][9, 2, 3][3, 1, 2, 0, 0][1]false32707",
    ),
    (
        "int[] a = {1, 2, 3, 4}; System.arraycopy(a, 0, a, 1, 3); println(Arrays.toString(a)); Arrays.fill(a, 1, 3, 7); println(Arrays.toString(a) + Arrays.binarySearch(new int[] {1, 3, 5}, 4)); println(Arrays.deepToString(new int[][] {{1}, {2, 3}}));",
        "[1, 1, 2, 3]\n[1, 7, 7, 3]-3\n[[1], [2, 3]]",
    ),
    (
        "println(Integer.compare(3, 1) + Integer.toString(-255, 16) + Integer.parseInt(\"-ff\", 16) + Integer.bitCount(255) + Long.toHexString(-1L) + Integer.toOctalString(9));",
        "1-ff-2558ffffffffffffffff11",
    ),
    (
        "println(Double.compare(0.0, -0.0) + \" \" + Double.compare(0.0 / 0, 1 / 0.0) + \" \" + Double.doubleToLongBits(1.5) + \" \" + Float.floatToIntBits(1f) + \" \" + Math.ulp(1.0) + \" \" + Math.IEEEremainder(5, 3) + \" \" + Math.floorMod(-7L, 3L));",
        "1 1 4609434218613702656 1065353216 2.220446049250313E-16 -1.0 2",
    ),
    (
        "try { Math.addExact(2147483647, 1); } catch (ArithmeticException e) { println(e.getMessage()); } try { Math.toIntExact(1L << 40); } catch (ArithmeticException e) { println(e); }",
        "integer overflow\njava.lang.ArithmeticException: integer overflow",
    ),
    (
        "println(String.join(\"-\", \"a\", \"b\") + \"ab\".repeat(2) + \" x \".strip() + \" \".isBlank() + \"a,b,c\".split(\",\", 2)[1] + \"a,,\".split(\",\", -1).length + String.valueOf(new char[] {'o', 'k'}) + Character.toUpperCase('q') + Character.getNumericValue('7'));",
        "a-bababxtrueb,c3okQ7",
    ),
    (
        "ArrayList<Float> l = new ArrayList<Float>(); l.add(1f); l.add(2); float s = 0; for (float f : l) s += f; s += l.get(1); println(s + \" \" + l + l.contains(2f) + l.indexOf(2f));",
        "5.0 [1.0, 2.0]true1",
    ),
    (
        "HashMap<String, Integer> m = new HashMap<String, Integer>(); m.put(\"a\", 1); m.put(\"b\", 2); int s = 0; for (Map.Entry<String, Integer> e : m.entrySet()) { s += e.getValue(); e.setValue(s); print(e.getKey()); } println(s + \" \" + m + m.putIfAbsent(\"a\", 9) + m.equals(new HashMap(m)));",
        "ab3 {a=1, b=3}1true",
    ),
    (
        "TreeMap<String, Double> t = new TreeMap<String, Double>(); t.put(\"z\", 1.0); t.put(\"a\", 2.0); println(t + t.firstKey() + t.lastKey()); TreeSet s = new TreeSet(); s.add(3); s.add(1); println(s + \"\" + s.first());",
        "{a=2.0, z=1.0}az\n[1, 3]1",
    ),
    (
        "LinkedList<Integer> l = new LinkedList<Integer>(); l.add(1); l.push(2); l.offer(3); println(l.peek() + l.poll() + l.pollLast() + \" \" + l + l.pop() + l.poll()); Stack<String> s = new Stack<String>(); s.push(\"a\"); s.push(\"b\"); println(s.search(\"a\") + s.peek());",
        "7 [1]1null\n2b",
    ),
    (
        "ArrayList<Integer> l = new ArrayList<Integer>(Arrays.asList(1, 2, 3, 4)); Iterator<Integer> i = l.iterator(); while (i.hasNext()) if (i.next() % 2 == 0) i.remove(); println(l + \"\" + l.subList(0, 1) + l.addAll(1, l) + l + l.lastIndexOf(3)); l.removeAll(Arrays.asList(3)); println(l + \" \" + l.toArray().length);",
        "[1, 3][1]true[1, 1, 3, 3]3\n[1, 1] 2",
    ),
    (
        "println(new Date(0) + \" \" + new SimpleDateFormat(\"yyyy-MM-dd HH:mm\").format(new Date(951825599000L)) + \" \" + new DecimalFormat(\"0.0#\").format(3.14159));",
        "Thu Jan 01 00:00:00 UTC 1970 2000-02-29 11:59 3.14",
    ),
    (
        "Object o = new int[2]; println(\"s\".getClass().getName() + \" \" + new ArrayList().getClass().getSimpleName()); Object[] all = new String[] {\"x\"}; println(all[0]); assert all == null : \"never looked at\"; synchronized (o) { println(Objects.equals(null, null)); }",
        "java.lang.String ArrayList\nx\ntrue",
    ),
];

#[test]
fn the_library_answers_as_javas_does() {
    for (body, expected) in LIBRARY {
        let found = printed(body).unwrap_or_else(|fault| panic!("{body}: {fault}"));
        assert_eq!(found.trim_end(), *expected, "{body}");
    }
}

/// Functions as values, in XL's own notation.
const FUNCTIONS: &str = r#"
module Leaf(float area);
class Curve { double k; Curve(double k) { this.k = k; } DoubleToDouble times() { return double x => k * x; } }
double integral(DoubleToDouble f, double a, double b) { double s = 0; for (int i = 0; i < 100; i++) s += f.evaluateDouble(a + (b - a) * (i + 0.5) / 100) * (b - a) / 100; return s; }
FloatToFloat twice = float t => float t * 2;
protected void init() {
	FloatToFloat f = float t => float t * t + 1;
	println(f.evaluateFloat(3) + " " + twice.evaluateFloat(1.5) + " " + Math.round(100 * integral(double x => x * x, 0, 3)));
	int n = 3; String s = "n";
	IntToInt g = int i => i * n; n = 4;
	println(g.evaluateInt(5) + " " + n + new Curve(2.5).times().evaluateDouble(2));
	ObjectToObject h = Object o => s + o;
	println(h.evaluateObject("!"));
	ObjectToFloat area = Leaf l => l.area;
	println(area.evaluateFloat(new Leaf(2)));
	FloatToFloat[] all = {f, twice, float t => -t};
	for (FloatToFloat one : all) print(one.evaluateFloat(2) + " ");
	try { area.evaluateFloat("x"); } catch (ClassCastException e) { println("no leaf"); }
}
"#;

#[test]
fn functions_are_values() {
    let expected = "10.0 3.0 900\n15 45.0\nn!\n2.0\n5.0 4.0 -2.0 no leaf\n";
    assert_eq!(printed_by(FUNCTIONS).unwrap(), expected);
    let slips = [
        (
            "FloatToFloat f = int i => i;",
            "expected `FloatToFloat`, found `IntToInt`",
        ),
        (
            "IntToInt f = int i => i; f.evaluateFloat(2);",
            "has no method `evaluateFloat`",
        ),
        (
            "int n = 0; IntToInt f = int i => n = i;",
            "`n` cannot be changed",
        ),
    ];
    for (slip, expected) in slips {
        let fault = printed(slip).expect_err(slip);
        assert!(fault.contains(expected), "{slip}: {fault}");
    }
}

/// Matrices of `javax.vecmath`; the figures were worked out by hand.
#[test]
fn matrices_turn_and_move() {
    let body = r#"
    Matrix4d m = new Matrix4d(); println(m.m00); m.rotZ(Math.PI / 2); m.setTranslation(new Vector3d(1, 2, 3));
    Point3d p = new Point3d(1, 0, 0); Vector3d v = new Vector3d(1, 0, 0); m.transform(p); m.transform(v);
    println(Math.round(p.x) + " " + Math.round(p.y) + " " + Math.round(p.z) + " " + Math.round(v.x) + " " + Math.round(v.y) + " " + m.m03 + m.getElement(2, 3));
    Matrix4d i = new Matrix4d(m); i.invert(); i.transform(p); println(Math.round(p.x) + " " + Math.round(p.y));
    Matrix3d t = new Matrix3d(1, 2, 3, 4, 5, 6, 7, 8, 10); println(Math.round(1000 * t.determinant()) + "\n" + t); t.transpose(); t.mul(2); t.m11 += 1; print(t);
    try { new Matrix4d().invert(); } catch (ArithmeticException e) { println(e.getMessage()); }
    try { t.getElement(3, 0); } catch (ArrayIndexOutOfBoundsException e) { println("no row"); }"#;
    let expected = "0.0\n1 3 3 0 1 1.03.0\n1 0\n-3000\n1.0, 2.0, 3.0\n4.0, 5.0, 6.0\n7.0, 8.0, 10.0\n\n2.0, 8.0, 14.0\n4.0, 11.0, 16.0\n6.0, 12.0, 20.0\n\
                    the matrix has no inverse\nno row\n";
    assert_eq!(printed(body).unwrap(), expected);
    let placed = "module A; protected void init() { [ Axiom ==> Translate(1, 2, 3) RU(90) A; ] derive(); A a = first((* A *)); \
        Point3d p = new Point3d(0, 0, 1); transformation(a).transform(p); println(Math.round(p.x) + \" \" + Math.round(p.y) + \" \" + Math.round(p.z) + transformation(a).m13); }";
    assert_eq!(printed_by(placed).unwrap(), "2 2 32.0\n");
}

/// Methods that Java calls by itself, enumerations, interfaces with constants, and the model as an object.
const OWN_METHODS: &str = r#"
enum Stage { SEED, LEAF(2.5), DEAD(0); double w; Stage() { w = 9; } Stage(double w) { this.w = w; } double twice() { return 2 * w; } }
Stage now = Stage.SEED;
interface Rated { int BASE = 7; int rate(); }
class Item implements Comparable, Rated {
	int v; Item(int v) { this.v = v; }
	public String toString() { return "I" + v; }
	public boolean equals(Object o) { return o instanceof Item && ((Item) o).v == v; }
	public int hashCode() { return v; }
	public int compareTo(Object o) { return v - ((Item) o).v; }
	int rate() { return BASE + v; }
}
class Down implements Comparator { public int compare(Object a, Object b) { return ((Item) b).v - ((Item) a).v; } }
class Box<T> { T held; Box(T held) { this.held = held; } T get() { return held; } }
class Log { void close() { println("closed"); } }
module Leaf(int n) { String toString() { return "leaf " + n; } }
int day = 3;
protected void startup() { super.startup(); day = 4; println("startup"); }
int twice(int day) { return 2 * this.day; }
protected void init() {
	Object o = new Item(3);
	println(o.toString() + o + o.equals(new Item(3)) + o.hashCode() + String.valueOf(o) + String.format("%s", o));
	ArrayList l = new ArrayList(); l.add(o); l.add(new Item(1)); l.add(new Leaf(5));
	println(l + " " + l.indexOf(new Item(1)) + l.contains(new Item(2)));
	l.remove(2); Collections.sort(l); print(l); Collections.sort(l, new Down()); print(l); Collections.sort(l, Collections.reverseOrder().reversed()); println(l);
	HashMap m = new HashMap(); m.put(o, "x"); m.put(new Item(3), "y"); println(m + "" + m.get(new Item(3)) + m.containsKey(new Item(4)));
	Item[] a = {new Item(5), new Item(2)}; Arrays.sort(a); println(Arrays.toString(a) + Collections.max(l));
	println(now + " " + Stage.LEAF.twice() + Stage.SEED.w + Stage.valueOf("DEAD").ordinal() + Stage.values().length + now.compareTo(Stage.DEAD) + (now == Stage.SEED));
	switch (now) { case LEAF: println("leaf"); break; case SEED: println("seed"); break; default: println("?"); }
	Rated r = new Item(1); println(r.rate() + Rated.BASE);
	println(new Box<String>("b").get() + " " + model.INSTANCE.day + INSTANCE.twice(1) + this.day);
	try (Log one = new Log()) { println("in"); throw new RuntimeException("r"); } catch (Exception e) { println(e.getMessage()); }
	try { Stage.valueOf("X"); } catch (IllegalArgumentException e) { println(e.getMessage()); }
	ArrayList bad = new ArrayList(); bad.add(new Leaf(1)); bad.add(new Leaf(2));
	try { Collections.sort(bad); } catch (ClassCastException e) { println("no order"); }
	[ Axiom ==> Leaf(1) [Leaf(2)] Leaf(3); ]
	derive();
	Leaf first = first((* Leaf *));
	println(first.getSuccessor() + "; " + first.getBranch() + "; " + first.getDirectChildCount() + (first.getSuccessor().getPredecessor() == first) + first.isAncestorOf(first.getBranch()) + first.getClass().getSimpleName());
}
"#;

#[test]
fn methods_of_the_model_are_called_by_the_library() {
    let expected = "startup\nI3I3true3I3I3\n[I3, I1, leaf 5] 1false\n[I1, I3][I3, I1][I1, I3]\n{I3=y}yfalse\n[I2, I5]I3\n\
                    SEED 5.09.023-2true\nseed\n15\nb 484\nin\nclosed\nr\nNo enum constant Stage.X\nno order\n\
                    leaf 3; leaf 2; 2truetrueLeaf\n";
    assert_eq!(printed_by(OWN_METHODS).unwrap(), expected);
}

/// What a collection was declared to hold is checked where the text can be, and where it cannot when it is taken out.
#[test]
fn type_arguments_are_checked() {
    let slips = [
        (
            "ArrayList<Float> l = new ArrayList<Float>(); l.add(\"x\");",
            "expected `Float`, found `String`",
        ),
        (
            "ArrayList<Float> l = new ArrayList<Float>(); String s = l.get(0);",
            "expected `String`, found `Float`",
        ),
        (
            "ArrayList<int> l;",
            "a collection cannot hold the plain type `int`",
        ),
        (
            "ArrayList<Float> l = new ArrayList<String>();",
            "expected `ArrayList<Float>`, found `ArrayList<String>`",
        ),
    ];
    for (slip, expected) in slips {
        let fault = printed(slip).expect_err(slip);
        assert!(fault.contains(expected), "{slip}: {fault}");
    }
    let late = "ArrayList<Float> l = new ArrayList<Float>(); ArrayList raw = l; raw.add(\"x\"); float f = l.get(0);";
    assert!(printed(late).unwrap_err().contains("is no Float"));
}

#[test]
fn collections_print_what_java_prints() {
    for (body, expected) in STATEMENTS {
        let found = printed(body).unwrap_or_else(|fault| panic!("{body}: {fault}"));
        assert_eq!(found.trim_end(), *expected, "{body}");
    }
}

#[test]
fn tables_are_filled_and_read() {
    let body = "DatasetRef d = new DatasetRef(\"t\"); d.(setColumnKey(0, \"time\"), setColumnKey(1, 7)); chart(d, XY_PLOT);
        d.addRow().(set(0, 1), set(1, 2.5)); d.getRow(2).set(1, 4L); Dataset e = new DatasetRef(\"t\").resolve();
        println(e.getRowCount() + \" \" + e.getColumnCount() + \" \" + e.getColumnKey(1) + \" \" + e.getCell(0, 1) + \" \" + e.getCell(2, 1) + e.getCell(1, 1));
        d.clear(); println(e.getRowCount());
        println(d.setTitle(\"u\").setRowKey(0, \"r\").setColumnKey(0, \"a\").setColumnKey(1, \"b\").getColumnKey(1));";
    assert_eq!(printed(body).unwrap(), "3 2 7 2.5 4null\n0\nb\n");
}

#[test]
fn a_run_without_files_refuses_them() {
    let fault =
        printed("try { new FileReader(\"x.txt\"); } catch (Exception e) { println(\"caught\"); }");
    assert!(fault.unwrap_err().contains("this run has no files"));
}
