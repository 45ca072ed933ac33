//! What the strict loader says about slips in scales, factors and identities.

use meterpoll::profile::load::load;

/// A profile with these lines from line 4, and two points behind them.
fn profile(lines: &str) -> String {
    format!(
        "name = \"m\"\ntitle = \"Meter\"\nmanual = \"Manual\"\n{lines}\n\
         [[points]]\nname = \"ct\"\naddress = 0\ntype = \"u16\"\n\
         [[points]]\nname = \"label\"\naddress = 1\ntype = \"ascii/2\"\n"
    )
}

/// A profile whose point `a` has these keys in line 10.
fn point(kind: &str, keys: &str) -> String {
    format!(
        "name = \"m\"\ntitle = \"Meter\"\nmanual = \"Manual\"\n\
         [factors]\nfull = {{ product = [2, \"ct\"] }}\n\
         [[points]]\nname = \"a\"\naddress = 0x10\ntype = \"{kind}\"\n{keys}\n\
         [[points]]\nname = \"ct\"\naddress = 0\ntype = \"u16\"\n\
         [[points]]\nname = \"order\"\naddress = 1\ntype = \"u16\"\naccess = \"write\"\n\
         [[points]]\nname = \"other\"\naddress = 2\ntype = \"u16\"\nscale = \"full\"\n"
    )
}

#[track_caller]
fn refused(text: &str, message: &str) {
    match load("m.toml", text) {
        Ok(_) => panic!("it loads:\n{text}"),
        Err(error) => assert_eq!(error.to_string(), message),
    }
}

#[test]
fn a_factor_that_needs_itself_is_shown_with_the_way_round() {
    refused(
        &profile("[factors]\na = { product = [\"b\", \"ct\"] }\nb = { product = [2, \"-a\"] }"),
        "m.toml:5: factors.a: goes round in a circle: a needs b needs a",
    );
    refused(
        &profile("[factors]\na = { by = \"ct\", cases = { 1 = 1 }, otherwise = \"a\" }"),
        "m.toml:5: factors.a: goes round in a circle: a needs a",
    );
}

#[test]
fn a_factor_is_of_things_there_are() {
    refused(
        &profile("[factors]\na = { product = [\"pt\"] }"),
        "m.toml:5: factors.a: there is no factor or point 'pt'",
    );
    refused(
        &profile("[factors]\na = { by = \"pt\", cases = { 1 = 1 } }"),
        "m.toml:5: factors.a.by: there is no point 'pt'",
    );
    refused(
        &profile("[factors]\na = { product = [\"label\"] }"),
        "m.toml:5: factors.a: \"label\" is not an integer that can be read and whose scale is a \
         number",
    );
}

#[test]
fn a_factor_is_a_product_or_a_choice() {
    let message = "m.toml:5: factors.a: give product = [...], or by = a point and cases = \
                   { code = number }";
    for rule in [
        "{}",
        "{ product = [] }",
        "{ product = [1], by = \"ct\" }",
        "{ product = [1], otherwise = 2 }",
        "{ by = \"ct\" }",
        "{ by = \"ct\", cases = {} }",
        "{ cases = { 1 = 2 } }",
    ] {
        refused(&profile(&format!("[factors]\na = {rule}")), message);
    }
}

#[test]
fn cases_are_codes_each_of_them_once() {
    refused(
        &profile("[factors]\na = { by = \"ct\", cases = { on = 1 } }"),
        "m.toml:5: factors.a.cases: on is not a code: 0 to 65535, or 0x0 to 0xFFFF",
    );
    refused(
        &profile("[factors]\na = { by = \"ct\", cases = { 1 = 1, 0x1 = 2 } }"),
        "m.toml:5: factors.a.cases: this code has a case already",
    );
}

#[test]
fn a_factor_has_a_name_of_its_own() {
    refused(
        &profile("[factors]\nct = { product = [1] }"),
        "m.toml:5: factors.ct: there is a point of this name",
    );
    refused(
        &profile("[factors]\nCT = { product = [1] }"),
        "m.toml:5: factors.CT: 'CT' is no name: small letters, digits and '_', a letter first",
    );
}

#[test]
fn a_scale_is_a_number_a_factor_or_a_plain_point() {
    refused(
        &point("u16", "scale = \"half\""),
        "m.toml:10: a.scale: there is no factor or point 'half'",
    );
    for name in ["order", "other", "a"] {
        refused(
            &point("u16", &format!("scale = \"{name}\"")),
            &format!(
                "m.toml:10: a.scale: \"{name}\" is not an integer that can be read and whose scale \
                 is a number"
            ),
        );
    }
    refused(
        &point("f32", "scale = \"full\""),
        "m.toml:10: a.scale: only an integer has such a scale",
    );
    assert!(load("m.toml", &point("u16", "scale = \"ct\"")).is_ok());
}

#[test]
fn bands_are_apart_and_not_empty() {
    refused(
        &point(
            "u16",
            "scale = [{ raw = [1, 5], factor = 1 }, { raw = [5, 9], factor = 2 }]",
        ),
        "m.toml:10: a.scale.raw: these raw numbers have a factor already",
    );
    for raw in ["[5, 1]", "[5]", "[]", "[-1, 5]", "[5, 65536]"] {
        refused(
            &point("u16", &format!("scale = [{{ raw = {raw}, factor = 1 }}]")),
            &format!("m.toml:10: a.scale.raw: {raw} is not [lowest, highest] raw number of u16"),
        );
    }
    refused(
        &point("u16", "scale = []"),
        "m.toml:10: a.scale: [] is not a list of { raw, factor }",
    );
}

#[test]
fn a_span_has_ends_that_are_there_and_a_full_scale() {
    refused(
        &point("u16", "span = { full = 0, low = 0, high = 1 }"),
        "m.toml:10: a.span.full: 0 is not above 0",
    );
    refused(
        &point("u16", "span = { full = 9, low = \"-half\", high = 1 }"),
        "m.toml:10: a.span.low: there is no factor or point 'half'",
    );
    refused(
        &point("u16", "span = { full = 9, low = 5, high = 5 }"),
        "m.toml:10: a.span.high: 5 is not another than low: between them lies nothing",
    );
    refused(
        &point("f32", "span = { full = 9, low = 0, high = 1 }"),
        "m.toml:10: a.span: only an integer has such a scale",
    );
    refused(
        &point("u16", "scale = 1\nspan = { full = 9, low = 0, high = 1 }"),
        "m.toml:10: a.scale: give either scale or span",
    );
    refused(
        &point("u16", "span = { full = 9, low = 0 }"),
        "m.toml:10: a.span.high: this key is missing",
    );
}

#[test]
fn what_a_point_means_something_with_is_another_point() {
    refused(
        &point("u16", "only_with = { point = \"wiring\", codes = [1] }"),
        "m.toml:10: a.only_with.point: there is no point 'wiring'",
    );
    refused(
        &point("u16", "only_with = { point = \"order\" }"),
        "m.toml:10: a.only_with.point: \"order\" is not a point that can be read and depends on no \
         other",
    );
    assert!(load("m.toml", &point("u16", "only_with = { point = \"ct\" }")).is_ok());
    refused(
        &point("u16", "only_with = { point = \"ct\", codes = [] }"),
        "m.toml:10: a.only_with.codes: [] is not a list of codes",
    );
}

#[test]
fn an_identity_is_one_of_six_laws() {
    let message = "m.toml:4: identities: give sum and of, mean and of, apparent and real and \
                   reactive, power_factor and real and apparent, line_voltage and between, or near \
                   and one_of";
    for keys in [
        "{}",
        "{ sum = \"ct\" }",
        "{ sum = \"ct\", of = [] }",
        "{ sum = \"ct\", mean = \"ct\", of = [\"ct\"] }",
        "{ apparent = \"ct\", real = \"ct\" }",
        "{ near = \"ct\" }",
    ] {
        refused(&profile(&format!("identities = [{keys}]")), message);
    }
}

#[test]
fn an_identity_is_of_numbers_that_can_be_read() {
    refused(
        &profile("identities = [{ sum = \"ct\", of = [\"pt\"] }]"),
        "m.toml:4: identities: there is no point 'pt'",
    );
    refused(
        &profile("identities = [{ near = \"label\", one_of = [50] }]"),
        "m.toml:4: identities: \"label\" is not a number that can be read",
    );
}

#[test]
fn a_tolerance_is_a_part() {
    for tolerance in ["0", "1", "-0.1", "2.5"] {
        refused(
            &profile(&format!(
                "identities = [{{ near = \"ct\", one_of = [50], tolerance = {tolerance} }}]"
            )),
            &format!("m.toml:4: identities.tolerance: {tolerance} is not above 0 and below 1"),
        );
    }
}

#[test]
fn what_is_told_by_codes_has_one_register() {
    let wide = "[factors]\na = { by = \"wide\", cases = { 1 = 1 } }\n\
                [[points]]\nname = \"wide\"\naddress = 8\ntype = \"u32\"";
    refused(
        &profile(wide),
        "m.toml:5: factors.a.by: \"wide\" is not a point of one register",
    );
    let letter = "[factors]\na = { product = [\"revision\"] }\n\
                  [[points]]\nname = \"revision\"\naddress = 8\ntype = \"letter\"";
    refused(
        &profile(letter),
        "m.toml:5: factors.a: \"revision\" is not an integer that can be read and whose scale is \
         a number",
    );
}

#[test]
fn one_minus_is_a_minus_and_two_are_a_slip() {
    refused(
        &profile("[factors]\na = { product = [\"--ct\"] }"),
        "m.toml:5: factors.a: there is no factor or point '-ct'",
    );
}

#[test]
fn many_factors_of_each_other_load_at_once() {
    use std::fmt::Write as _;

    let mut lines = "[factors]\n".to_owned();
    for number in 0..2000 {
        let next = number + 1;
        let _ = writeln!(
            lines,
            "f{number} = {{ product = [\"f{next}\", \"f{next}\"] }}"
        );
    }
    let round = format!("{lines}f2000 = {{ product = [\"f1999\"] }}");
    refused(
        &profile(&round),
        "m.toml:2004: factors.f1999: goes round in a circle: f1999 needs f2000 needs f1999",
    );
    let chain = format!("{lines}f2000 = {{ product = [\"ct\"] }}");
    assert!(load("m.toml", &profile(&chain)).is_ok());
}

#[test]
fn names_of_label_tables_are_names() {
    refused(
        &profile("[labels]\n\"\\u001b[31m\" = { 1 = \"on\" }"),
        "m.toml:5: labels.\u{1b}[31m: '\u{1b}[31m' is no name: small letters, digits and '_', a \
         letter first",
    );
}
