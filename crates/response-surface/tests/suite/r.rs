//! The analyses agree with those of R on data sets that come with R.
//!
//! Limit: 1e-8 relative. R holds coefficients to about 1e-10 on the worst of these sets (squares in
//! natural units); the measured worst difference is printed by the example `r_agreement`.

mod table;

#[test]
fn every_quantity_of_every_data_set_agrees_with_r() {
    let rows = table::rows().unwrap();
    assert_eq!(rows.len(), 15);
    for row in rows {
        assert!(row.differences.len() >= 8);
        for (quantity, difference) in row.differences {
            // A quantity that is not a number fails as well.
            assert!(
                difference <= 1e-8,
                "{}, {quantity}: {difference:e}",
                row.name
            );
        }
    }
}
