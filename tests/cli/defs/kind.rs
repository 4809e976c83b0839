//! Tests of `kt830::defs::kind`.

use kt830::defs::equipment::Equipment;
use kt830::defs::kind::Kind;

#[test]
fn k1_the_wheel_axis_homes_first_and_carries_the_wheel() {
    for kind in Kind::ALL {
        let row = kind.row();
        assert_eq!(row.home_order.first(), Some(&row.wheel_axis), "{kind:?}");
        assert_eq!(row.ui.wheel_pose.is_some(), row.has(Equipment::Wheel), "{kind:?}");
        assert!(row.ui.wheel_pose.is_none_or(|pose| pose.body == row.wheel_axis), "{kind:?}");
        assert_eq!(row.ui.grinding_forms.is_empty(), row.is_lathe(), "{kind:?}");
    }
}

#[test]
fn k1_the_story_of_a_kind_names_the_kind() {
    for kind in Kind::ALL {
        let line = format!("kind {}", kind.id());
        let told = kind.row().demo_story;
        assert!(told.is_none_or(|story| story.lines().any(|found| found.trim() == line)), "{kind:?}");
    }
}

#[test]
fn k1_a_kind_has_one_id_one_workpiece_drive_and_a_folder_of_its_own_programs() {
    for (index, kind) in Kind::ALL.into_iter().enumerate() {
        let row = kind.row();
        assert_eq!(Kind::from_id(row.id), Some(kind));
        assert!(Kind::ALL[..index].iter().all(|other| other.short_name() != row.short_name), "{kind:?}");
        // P153 assigns the port of each workpiece drive.
        let drives = row.equipment.iter().filter(|device| device.work_drive().is_some()).count();
        assert_eq!(drives, usize::from(!row.is_lathe()), "{kind:?}");
        assert_eq!(row.programs.folder.is_empty(), row.programs.shipped.is_empty(), "{kind:?}");
    }
    assert!(Kind::default().row().demo_story.is_some());
    // The settings page shows the KT-830 kinds before the others.
    assert!(Kind::kt830().eq(Kind::ALL.into_iter().take_while(|kind| kind.name().zh.starts_with("KT-830"))));
}
